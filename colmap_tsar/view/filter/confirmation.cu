// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/confirmation.h"

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/view/denoise/window_variance.h"

namespace tsar {
namespace {

// The least own texture of a pixel whose depth counts as measured, in
// variances of the noise. A pixel without texture takes the depth of an edge
// nearby in all views, which then agree on a wrong depth.
constexpr float kMinTexture = 2.f;

struct ConfirmationKernel {
  ImageView<const float> gray;
  ImageView<const uint8_t> agreement;
  NoiseCurve noise;

  TSAR_HD uint8_t operator()(int x, int y) const {
    return static_cast<uint8_t>(Judge(x, y));
  }

  TSAR_HD Confirmation Judge(int x, int y) const {
    if (agreement(x, y) == 0) {
      return Confirmation::kNone;
    }
    const float texture = OwnTexture(gray, x, y);
    if (texture < kMinTexture * noise.Variance(gray(x, y))) {
      return Confirmation::kNone;
    }
    return texture < kDistinctTexture ? Confirmation::kWeak
                                      : Confirmation::kDistinct;
  }
};

}  // namespace

DeviceImage<uint8_t> ConfirmDepths(ImageView<const float> gray,
                                   ImageView<const uint8_t> agreement,
                                   const NoiseCurve& noise,
                                   Device& device) {
  return MapPixels<uint8_t>(device,
                            gray.width,
                            gray.height,
                            ConfirmationKernel{gray, agreement, noise});
}

}  // namespace tsar
