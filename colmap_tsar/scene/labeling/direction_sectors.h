// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cmath>

namespace tsar {

// The set of those of eight sectors, of 45 degrees each, in which there are
// observations around a point of a plane or an image.
class DirectionSectors {
 public:
  // The number of sectors with observations around a point from which a surface
  // is known there.
  static constexpr int kNumKnown = 7;

  // x, y: relative to the point.
  TSAR_HD void Add(float x, float y) {
    const unsigned sector = (x > 0.f ? 1u : 0u) | (y > 0.f ? 2u : 0u) |
                            (fabsf(x) > fabsf(y) ? 4u : 0u);
    sectors_ |= 1u << sector;
  }

  TSAR_HD int Count() const {
    int count = 0;
    for (int i = 0; i < 8; ++i) {
      count += static_cast<int>(sectors_ >> i & 1u);
    }
    return count;
  }

 private:
  unsigned sectors_ = 0;
};

}  // namespace tsar
