// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/denoise/estimate_noise.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

constexpr int kBlock = 8;
// A plane of three parameters is subtracted from each block.
constexpr int kDegreesOfFreedom = kBlock * kBlock - 3;
// Largest ratio of a block's variance to that estimated from mixed second
// differences: 1 for white noise, 9 for noise averaged over 3 x 3 pixels, 100
// or more for waves of ten pixels, which are texture.
constexpr float kMaxSmoothness = 12.f;

struct BlockKernel {
  ImageView<const float> gray;
  ImageView<BlockStatistics> blocks;

  TSAR_HD void operator()(int column, int row) const {
    constexpr float kMiddle = 0.5f * (kBlock - 1);
    constexpr float kMeanSquare = (kBlock * kBlock - 1) / 12.f;
    const int x0 = column * kBlock;
    const int y0 = row * kBlock;
    // Levels are taken relative to one pixel, which keeps the digits in which
    // flat blocks differ.
    const float base = gray(x0, y0);
    float sum = 0.f;
    float squares = 0.f;
    float along_x = 0.f;
    float along_y = 0.f;
    for (int v = 0; v < kBlock; ++v) {
      for (int u = 0; u < kBlock; ++u) {
        const float level = gray(x0 + u, y0 + v) - base;
        sum += level;
        squares += level * level;
        along_x += level * (static_cast<float>(u) - kMiddle);
        along_y += level * (static_cast<float>(v) - kMiddle);
      }
    }
    float mixed = 0.f;
    for (int v = 1; v < kBlock; ++v) {
      for (int u = 1; u < kBlock; ++u) {
        const float difference =
            (gray(x0 + u, y0 + v) - gray(x0 + u - 1, y0 + v)) -
            (gray(x0 + u, y0 + v - 1) - gray(x0 + u - 1, y0 + v - 1));
        mixed += difference * difference;
      }
    }
    constexpr float kDifferences = 4 * (kBlock - 1) * (kBlock - 1);
    constexpr float kArea = kBlock * kBlock;
    const float mean = sum / kArea;
    const float of_gradient =
        (along_x * along_x + along_y * along_y) / (kArea * kMeanSquare);
    const float rest = squares - kArea * mean * mean - of_gradient;
    const float variance = fmaxf(rest, 0.f) / kDegreesOfFreedom;
    blocks(column, row) = {
        base + mean, fminf(variance, kMaxSmoothness * mixed / kDifferences)};
  }
};

}  // namespace

NoiseCurve EstimateNoise(ImageView<const float> gray, Device& device) {
  DeviceImage<BlockStatistics> blocks(
      device, gray.width / kBlock, gray.height / kBlock);
  ParallelFor(device,
              blocks.Width(),
              blocks.Height(),
              BlockKernel{gray, blocks.View()});
  const Image<BlockStatistics> on_host = blocks.ToHost();
  return FitNoiseCurve({on_host.begin(), on_host.end()}, kDegreesOfFreedom);
}

}  // namespace tsar
