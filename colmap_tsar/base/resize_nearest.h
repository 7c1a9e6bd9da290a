// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

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

}  // namespace tsar
