// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/denoise/noise_curve.h"

#include <cstdint>

namespace tsar {

// The noise of a gray image (0-255), from its flattest blocks of 8 x 8 pixels.
// Compression and resizing correlate the noise of adjacent pixels, which
// differences between them would not show: the variance of blocks does. Only
// where it exceeds that of differences by far, it is that of a smooth texture.
NoiseCurve EstimateNoise(ImageView<const float> gray, Device& device);

}  // namespace tsar
