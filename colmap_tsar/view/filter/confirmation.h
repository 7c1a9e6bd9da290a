// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"

#include <cstdint>

namespace tsar {

// Whether other views confirm the depth of a pixel.
enum class Confirmation : uint8_t {
  kNone = 0,
  kWeak = 1,      // Confirmed; the pixel's own texture is weak.
  kDistinct = 2,  // Confirmed; the pixel's own texture is distinct.
};

// The Confirmation of each pixel: other views agree with its depth, and the
// pixel itself has texture. gray: 0-255, of the map's size. agreement: number
// of agreeing views.
DeviceImage<uint8_t> ConfirmDepths(ImageView<const float> gray,
                                   ImageView<const uint8_t> agreement,
                                   const NoiseCurve& noise,
                                   Device& device);

}  // namespace tsar
