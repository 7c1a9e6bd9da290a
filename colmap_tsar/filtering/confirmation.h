// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/noise/noise_curve.h"

#include <cstdint>

namespace tsar {

struct ConfirmationOptions {
  // The 5 x 5 pixels around a depth that counts as measured vary by at least so
  // many variances of the noise. Without texture of its own a pixel takes the
  // depth of whatever edge lies in its matching window, and so it does in the
  // other views, which then agree on a wrong depth.
  float min_texture = 2.f;
};

// For each pixel, how many other views confirm its depth: the agreeing ones
// where the pixel itself has texture, otherwise none.
// gray: 0-255, of the map's size. is_candidate: 0 where a depth cannot be
// confirmed; empty: nowhere.
DeviceImage<uint8_t> CountConfirmations(ImageView<const float> gray,
                                        ImageView<const uint8_t> agreement,
                                        ImageView<const uint8_t> is_candidate,
                                        const NoiseCurve& noise,
                                        const ConfirmationOptions& options,
                                        Device& device);

}  // namespace tsar
