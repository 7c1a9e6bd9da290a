// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/denoise/noise_curve.h"

#include <cstdint>

namespace tsar {

// Estimates the noise of a gray image (0-255) from its flattest blocks of 8 x 8
// pixels. Compression and resizing correlate the noise of adjacent pixels,
// which the variance of blocks shows and differences between adjacent pixels do
// not. A block whose variance exceeds that of differences by far holds smooth
// texture.
NoiseCurve EstimateNoise(ImageView<const float> gray, Device& device);

}  // namespace tsar
