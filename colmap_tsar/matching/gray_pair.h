// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/buffer.h"

#include <cmath>
#include <cstdint>

namespace tsar {

// An element of a gray image in the form for interpolation: the gray levels of
// a pixel and of its right neighbor, so that a bilinear sample takes two loads
// instead of four. The last pixel of a row is its own neighbor.
struct GrayPair {
  uint32_t word = 0;  // The pixel's level is the low half.
};

// The unit of the samples of an image, in gray levels (0-255).
template <typename Element>
inline constexpr float kGrayUnit = 1.f;
template <>
inline constexpr float kGrayUnit<GrayPair> = 1.f / 256.f;

// A gray level, clamped to 0-255, as an integer; NaN becomes 0.
TSAR_HD inline uint32_t QuantizeGray(float gray) {
  constexpr float kPerLevel = 1.f / kGrayUnit<GrayPair>;
  return static_cast<uint32_t>(fminf(fmaxf(gray, 0.f), 255.f) * kPerLevel +
                               0.5f);
}

TSAR_HD inline GrayPair MakeGrayPair(float own, float right) {
  return {QuantizeGray(own) | QuantizeGray(right) << 16};
}

DeviceImage<GrayPair> PairGray(ImageView<const float> gray, Device& device);

DeviceImage<float> ComputeGray(ImageView<const Rgb> color, Device& device);

// pairs: of the size of the image.
void ComputeGrayPairs(ImageView<const Rgb> color,
                      ImageView<GrayPair> pairs,
                      Device& device);

// The image at half the width and height, rounded down, but at least one pixel:
// each pixel is the mean of four.
DeviceImage<float> HalveGray(ImageView<const float> gray, Device& device);
DeviceImage<GrayPair> HalveGray(ImageView<const GrayPair> gray, Device& device);

}  // namespace tsar
