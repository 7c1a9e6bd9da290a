// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/denoise/denoise.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/denoise/denoise_kernels.cuh"

#include <algorithm>
#include <cstdint>

namespace tsar {
namespace {

void DenoiseBands(const Denoising& denoising, Device& device) {
  constexpr int kMaxRows = DenoiseBandKernel::kMaxRows;
  const int height = denoising.color.height;
  const auto denoise = [&](int64_t first_band, int64_t last_band) {
    DenoiseBandKernel kernel(denoising);
    for (int64_t band = first_band; band < last_band; ++band) {
      const int y = static_cast<int>(band) * kMaxRows;
      kernel(y, std::min(y + kMaxRows, height));
    }
  };
  device.Threads().Run((height + kMaxRows - 1) / kMaxRows, denoise);
}

}  // namespace

DeviceImage<Rgb> Denoise(ImageView<const Rgb> color,
                         ImageView<const float> gray,
                         const NoiseCurve& noise,
                         Device& device) {
  DeviceImage<Rgb> denoised(device, color.width, color.height);
  const Denoising denoising{color, gray, noise, denoised.View()};
  if (device.IsCuda()) {
    ParallelFor(
        device, color.width, color.height, DenoisePixelKernel{denoising});
  } else {
    DenoiseBands(denoising, device);
  }
  return denoised;
}

}  // namespace tsar
