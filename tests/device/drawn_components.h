// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Rasters whose connected components are hard to find. A negative value is a
// pixel that belongs to no component.

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/random.h"

#include <utility>

namespace tsar {

// Joins neighbors whose values differ by at most 1.
struct SimilarValue {
  const int* values;
  TSAR_HD bool Contains(int i) const { return values[i] >= 0; }
  TSAR_HD bool Connected(int i, int j) const {
    const int difference = values[i] - values[j];
    return difference >= -1 && difference <= 1;
  }
};

// Values in {-1, ..., num_values - 2}.
inline Image<int> DrawNoise(int width,
                            int height,
                            int num_values,
                            uint32_t seed) {
  Image<int> values(width, height);
  Philox random(seed, 0, 0);
  for (int& value : values) {
    value = static_cast<int>(random.NextBelow(num_values)) - 1;
  }
  return values;
}

// One corridor that spirals inwards: the worst case for joining trees.
inline Image<int> DrawSpiral(int width, int height) {
  Image<int> values(width, height, -1);
  int x = 0;
  int y = 0;
  int dx = 1;
  int dy = 0;
  values(x, y) = 0;
  for (int turns = 0; turns < 2;) {
    const int ahead_x = x + 2 * dx;
    const int ahead_y = y + 2 * dy;
    const bool blocked =
        !values.Contains(x + dx, y + dy) ||
        (values.Contains(ahead_x, ahead_y) && values(ahead_x, ahead_y) >= 0);
    if (blocked) {
      std::swap(dx, dy);
      dx = -dx;
      ++turns;
    } else {
      turns = 0;
      x += dx;
      y += dy;
      values(x, y) = 0;
    }
  }
  return values;
}

// One corridor along every other row, or column, that turns at both ends.
inline Image<int> DrawSnake(int width, int height, bool along_rows) {
  Image<int> values(width, height, -1);
  const int length = along_rows ? width : height;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int along = along_rows ? x : y;
      const int across = along_rows ? y : x;
      const int turn = across % 4 == 1 ? length - 1 : 0;
      if (across % 2 == 0 || along == turn) {
        values(x, y) = 0;
      }
    }
  }
  return values;
}

}  // namespace tsar
