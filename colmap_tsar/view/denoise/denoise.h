// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

namespace tsar {

// Non-local means (Buades et al., CVPR 2005) with weights adapted to the noise:
// where it is weak, little changes, and steps above the noise stay sharp. gray:
// brightness of the same pixels, 0-255.
DeviceImage<Rgb> Denoise(ImageView<const Rgb> color,
                         ImageView<const float> gray,
                         const NoiseCurve& noise,
                         Device& device);

}  // namespace tsar
