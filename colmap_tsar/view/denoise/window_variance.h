// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"

namespace tsar {

// The variance of the gray levels in the part of the window of this radius
// around a pixel that lies in the image. Rounding can make it slightly
// negative.
TSAR_HD inline float WindowVariance(const ImageView<const float>& gray,
                                    int x,
                                    int y,
                                    int radius) {
  const float middle = gray(x, y);
  int count = 0;
  float sum = 0.f;
  float squares = 0.f;
  for (int v = y - radius; v <= y + radius; ++v) {
    for (int u = x - radius; u <= x + radius; ++u) {
      if (gray.Contains(u, v)) {
        // Levels are relative to the center: the squares of absolute levels
        // would lose the digits in which flat windows differ.
        const float difference = gray(u, v) - middle;
        ++count;
        sum += difference;
        squares += difference * difference;
      }
    }
  }
  const float mean = sum / count;
  return squares / count - mean * mean;
}

// A pixel's own texture: the variance of the gray levels, of 0-255, in the 5 x
// 5 pixels around it. Matching windows are wider: without texture of its own, a
// pixel gets the depth of any edge in its window.
TSAR_HD inline float OwnTexture(const ImageView<const float>& gray,
                                int x,
                                int y) {
  return WindowVariance(gray, x, y, 2);
}

// The least variance of distinct texture. With less, noise and the texture
// nearby move a depth by up to 2 % even where other views agree with it.
constexpr float kDistinctTexture = 64.f;

}  // namespace tsar
