// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_pair.h"

namespace tsar {

// The brightness of a color image, 0-255, as matching uses it. gray has the
// size of color.
void ComputeGray(ImageView<const Rgb> color,
                 ImageView<float> gray,
                 Device& device);
DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device);

// The brightness as pixel pairs, from which source views are interpolated.
void ComputeGrayPairs(ImageView<const Rgb> color,
                      ImageView<GrayPair> pairs,
                      Device& device);

// The image at half the width and height, rounded down, but at least one pixel:
// each pixel is the mean of four.
DeviceImage<float> HalveGray(ImageView<const float> gray, Device& device);

}  // namespace tsar
