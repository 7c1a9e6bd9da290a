// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/filtering/confirmation.h"

#include "colmap_tsar/device/parallel_for.h"

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
    const float middle = gray(x, y);
    int count = 0;
    float sum = 0.f;
    float squares = 0.f;
    for (int v = y - kRadius; v <= y + kRadius; ++v) {
      for (int u = x - kRadius; u <= x + kRadius; ++u) {
        if (gray.Contains(u, v)) {
          // Relative to the middle, which keeps the digits in which flat
          // windows differ.
          const float difference = gray(u, v) - middle;
          ++count;
          sum += difference;
          squares += difference * difference;
        }
      }
    }
    const float mean = sum / static_cast<float>(count);
    const float variance = squares / static_cast<float>(count) - mean * mean;
    return variance >= options.min_texture * noise.Variance(middle);
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
