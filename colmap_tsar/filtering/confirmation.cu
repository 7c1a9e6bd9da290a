// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/filtering/confirmation.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/noise/window_variance.cuh"

namespace tsar {
namespace {

constexpr int kRadius = 2;

struct ConfirmationKernel {
  ImageView<const float> gray;
  ImageView<const uint8_t> agreement;
  ImageView<const uint8_t> is_candidate;
  NoiseCurve noise;
  ConfirmationOptions options;
  ImageView<uint8_t> confirmations;

  TSAR_HD void operator()(int x, int y) const {
    const uint8_t agreeing = agreement(x, y);
    const bool can_be = is_candidate.Empty() || is_candidate(x, y) != 0;
    confirmations(x, y) =
        agreeing > 0 && can_be && HasTexture(x, y) ? agreeing : 0;
  }

  TSAR_HD bool HasTexture(int x, int y) const {
    return WindowVariance(gray, x, y, kRadius) >=
           options.min_texture * noise.Variance(gray(x, y));
  }
};

}  // namespace

DeviceImage<uint8_t> CountConfirmations(ImageView<const float> gray,
                                        ImageView<const uint8_t> agreement,
                                        ImageView<const uint8_t> is_candidate,
                                        const NoiseCurve& noise,
                                        const ConfirmationOptions& options,
                                        Device& device) {
  DeviceImage<uint8_t> confirmations(device, gray.width, gray.height);
  ParallelFor(
      device,
      gray.width,
      gray.height,
      ConfirmationKernel{
          gray, agreement, is_candidate, noise, options, confirmations.View()});
  return confirmations;
}

}  // namespace tsar
