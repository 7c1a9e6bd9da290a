// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>

namespace tsar {

// The image at another size: each pixel is the one under its middle, so that
// values that must not be averaged, such as labels, stay what they are. To: the
// type of the result's pixels.
template <typename To, typename From>
Image<To> ResizeNearest(const Image<From>& image, int width, int height) {
  const auto under = [](int64_t i, int64_t from, int64_t to) {
    return static_cast<int>((2 * i + 1) * from / (2 * to));
  };
  Image<To> resized = Image<To>::Uninitialized(width, height);
  for (int y = 0; y < height; ++y) {
    const int row = under(y, image.Height(), height);
    for (int x = 0; x < width; ++x) {
      resized(x, y) = To{image(under(x, image.Width(), width), row)};
    }
  }
  return resized;
}

}  // namespace tsar
