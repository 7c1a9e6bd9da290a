// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/noise/denoise.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

struct DenoiseKernel {
  ImageView<const Rgb> color;
  ImageView<const float> gray;
  NoiseCurve noise;
  DenoiseOptions options;
  ImageView<Rgb> denoised;

  TSAR_HD void operator()(int x, int y) const {
    const float variance = noise.Variance(gray(x, y));
    // Two samples of noise differ by twice its variance.
    const float expected = 2.f * variance;
    const float per_excess = 1.f / (options.strength * variance);
    float r = color(x, y).r;
    float g = color(x, y).g;
    float b = color(x, y).b;
    float sum = 1.f;
    const int reach = options.search_radius;
    for (int v = y - reach; v <= y + reach; ++v) {
      for (int u = x - reach; u <= x + reach; ++u) {
        if (!gray.Contains(u, v) || (u == x && v == y)) {
          continue;
        }
        const float excess = fmaxf(Difference(x, y, u, v) - expected, 0.f);
        // Not exp(), which the devices round differently.
        const float likeness = fmaxf(1.f - excess * per_excess, 0.f);
        const float weight = likeness * likeness;
        r += weight * color(u, v).r;
        g += weight * color(u, v).g;
        b += weight * color(u, v).b;
        sum += weight;
      }
    }
    denoised(x, y) = {Level(r / sum), Level(g / sum), Level(b / sum)};
  }

  // The mean squared difference of the patches around two pixels, as far as
  // both lie in the image.
  TSAR_HD float Difference(int x, int y, int u, int v) const {
    const int radius = options.patch_radius;
    float sum = 0.f;
    int count = 0;
    for (int j = -radius; j <= radius; ++j) {
      for (int i = -radius; i <= radius; ++i) {
        if (gray.Contains(x + i, y + j) && gray.Contains(u + i, v + j)) {
          const float difference = gray(x + i, y + j) - gray(u + i, v + j);
          sum += difference * difference;
          ++count;
        }
      }
    }
    return sum / static_cast<float>(count);
  }

  TSAR_HD static uint8_t Level(float level) {
    return static_cast<uint8_t>(level + 0.5f);
  }
};

}  // namespace

DeviceImage<Rgb> Denoise(ImageView<const Rgb> color,
                         ImageView<const float> gray,
                         const NoiseCurve& noise,
                         const DenoiseOptions& options,
                         Device& device) {
  DeviceImage<Rgb> denoised(device, color.width, color.height);
  ParallelFor(device,
              color.width,
              color.height,
              DenoiseKernel{color, gray, noise, options, denoised.View()});
  return denoised;
}

}  // namespace tsar
