// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"

#include <vector>

namespace tsar {

// The noise of an image: its variance at a gray level on 0-255. Photon noise
// grows with the level; the sensor and 8-bit levels add a constant: sigma^2(I)
// = constant + per_level I (Foi et al., Practical Poissonian-Gaussian noise
// modeling and fitting, IEEE TIP 2008).
struct NoiseCurve {
  float constant = 0.f;
  float per_level = 0.f;

  TSAR_HD float Variance(float level) const {
    return constant + per_level * level;
  }
};

// Mean and variance of a small block of an image, the latter after a linear
// gradient is subtracted.
struct BlockStatistics {
  float mean = 0.f;
  float variance = 0.f;
};

// Fits the curve to the variances of the flattest blocks of every brightness,
// which contain only noise. Blocks of underexposed or overexposed areas, where
// levels are clipped, are ignored. If there are no others, the result is the
// noise of rounding to 8 bits.
NoiseCurve FitNoiseCurve(const std::vector<BlockStatistics>& blocks);

// Estimates the noise of a gray image (0-255) from its flattest blocks of 8 x 8
// pixels. Compression and resizing correlate the noise of adjacent pixels,
// which the variance of blocks shows and differences between adjacent pixels do
// not. A block whose variance far exceeds that of differences contains smooth
// texture.
NoiseCurve EstimateNoise(ImageView<const float> gray, Device& device);

}  // namespace tsar
