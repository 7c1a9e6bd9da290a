// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <vector>

namespace tsar {

// How noisy an image is: the variance of the noise at a grey level, both on
// 0-255. Photons make it grow with the light, the sensor and 8-bit levels
// give it a floor: sigma^2(I) = constant + per_level I (Foi et al., Practical
// Poissonian-Gaussian noise modeling and fitting, IEEE TIP 2008).
struct NoiseCurve {
  float constant = 0.f;
  float per_level = 0.f;

  TSAR_HD float Variance(float level) const {
    return constant + per_level * level;
  }
};

// Mean and variance of a small block of an image, the variance without what a
// linear gradient causes.
struct BlockStatistics {
  float mean = 0.f;
  float variance = 0.f;
};

// The curve below the variances of most blocks: those of the flattest blocks of
// every brightness, which hold noise alone. Blocks of dark or burnt areas,
// where levels are clipped, do not count. Without any others, the noise of
// rounding to 8 bits. degrees_of_freedom: of each block's variance.
NoiseCurve FitNoiseCurve(const std::vector<BlockStatistics>& blocks,
                         int degrees_of_freedom);

}  // namespace tsar
