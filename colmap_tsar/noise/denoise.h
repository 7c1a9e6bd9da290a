// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/noise/noise_curve.h"

#include <cstdint>

namespace tsar {

struct DenoiseOptions {
  // Pixels around are averaged with a pixel whose surroundings look alike.
  int search_radius = 5;
  int patch_radius = 1;
  // Patches look alike whose mean squared difference exceeds that of noise by
  // less than this many variances of the noise.
  float strength = 4.f;
};

// Non-local means (Buades et al., CVPR 2005) with weights that follow the
// noise: where it is weak, little changes, and a step that stands out of the
// noise stays as sharp as it is. gray: of the same image.
DeviceImage<Rgb> Denoise(ImageView<const Rgb> color,
                         ImageView<const float> gray,
                         const NoiseCurve& noise,
                         const DenoiseOptions& options,
                         Device& device);

}  // namespace tsar
