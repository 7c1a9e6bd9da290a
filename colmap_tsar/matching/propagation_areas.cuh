// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"

namespace tsar {

// The eight areas from which a pixel may adopt a plane: in each of the four
// directions a near one, V-shaped, and a far one, a strip. All of their pixels
// have the other color of the checkerboard, so that none changes meanwhile.
constexpr int kNumPropagationAreas = 8;
constexpr int kNearAreaSize = 7;
constexpr int kFarAreaSize = 11;

struct PixelOffset {
  int x;
  int y;
};

// Member i of the near area that opens upwards: (0, -1), (-1, -2), (1, -2), ...
TSAR_HD inline PixelOffset NearAreaOffset(int i) {
  const int step = (i + 1) / 2;
  return {i % 2 == 0 ? step : -step, -1 - step};
}

// Member i of the far area upwards: (0, -3), (0, -5), ... (0, -23).
TSAR_HD inline PixelOffset FarAreaOffset(int i) { return {0, -3 - 2 * i}; }

// The offset rotated by quarter turns.
TSAR_HD inline PixelOffset Turned(const PixelOffset& offset, int turns) {
  switch (turns) {
    case 0:
      return offset;
    case 1:
      return {-offset.y, offset.x};
    case 2:
      return {-offset.x, -offset.y};
    default:
      return {offset.y, -offset.x};
  }
}

// The pixel of lowest cost in the area, the first of several; false if the area
// lies outside of the image.
TSAR_HD inline bool BestOfArea(const ImageView<const float>& costs,
                               int x,
                               int y,
                               int area,
                               PixelOffset* best) {
  const bool near = area < 4;
  const int size = near ? kNearAreaSize : kFarAreaSize;
  bool found = false;
  float lowest = 0.f;
  for (int i = 0; i < size; ++i) {
    const PixelOffset offset =
        Turned(near ? NearAreaOffset(i) : FarAreaOffset(i), area % 4);
    const int u = x + offset.x;
    const int v = y + offset.y;
    if (u < 0 || v < 0 || u >= costs.width || v >= costs.height) {
      continue;
    }
    const float cost = costs(u, v);
    if (!found || cost < lowest) {
      found = true;
      lowest = cost;
      *best = {u, v};
    }
  }
  return found;
}

}  // namespace tsar
