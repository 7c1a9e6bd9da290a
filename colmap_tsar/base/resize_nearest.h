// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <algorithm>
#include <cstdint>

namespace tsar {

// Of a side that is reduced to `to` pixels from `from`, the one under the
// middle of pixel i.
inline int NearestPixel(int64_t i, int64_t from, int64_t to) {
  return static_cast<int>((2 * i + 1) * from / (2 * to));
}

// The length of a side once the longer one is at most max_side; at least 1.
inline int ReducedLength(int length, int longer_side, int max_side) {
  if (longer_side <= max_side) {
    return length;
  }
  const auto rounded =
      (int64_t{2} * length * max_side + longer_side) / (2 * longer_side);
  return std::max(1, static_cast<int>(rounded));
}

// The image at another size: each pixel is the one under its middle, so that
// values that must not be averaged, such as labels, stay what they are. To: the
// type of the result's pixels.
template <typename To, typename From>
Image<To> ResizeNearest(const Image<From>& image, int width, int height) {
  Image<To> resized = Image<To>::Uninitialized(width, height);
  for (int y = 0; y < height; ++y) {
    const int row = NearestPixel(y, image.Height(), height);
    for (int x = 0; x < width; ++x) {
      resized(x, y) = To{image(NearestPixel(x, image.Width(), width), row)};
    }
  }
  return resized;
}

}  // namespace tsar
