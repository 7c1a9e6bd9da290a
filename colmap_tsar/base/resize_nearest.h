// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <algorithm>
#include <cstdint>

namespace tsar {

// For a side of `from` pixels resized to `to`, the pixel at the center of pixel
// i.
inline int NearestPixel(int64_t i, int64_t from, int64_t to) {
  return static_cast<int>((2 * i + 1) * from / (2 * to));
}

// The length of a side after the longer one is reduced to at most max_side; at
// least 1.
inline int ReducedLength(int length, int longer_side, int max_side) {
  if (longer_side <= max_side) {
    return length;
  }
  const auto rounded =
      (int64_t{2} * length * max_side + longer_side) / (2 * longer_side);
  return std::max(1, static_cast<int>(rounded));
}

// Nearest-neighbor resizing, for values that must not be averaged, such as
// labels. To: the type of the result's pixels.
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
