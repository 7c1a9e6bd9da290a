// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/denoise/estimate_noise.h"

#include "colmap_tsar/device/parallel_for.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

// Variance of rounding to integer levels.
constexpr double kQuantizationVariance = 1.0 / 12.0;
// Gray levels outside of these may be clipped.
constexpr float kMinLevel = 8.f;
constexpr float kMaxLevel = 247.f;
// Blocks are compared with those of about the same brightness.
constexpr int kNumBins = 16;
constexpr size_t kMinBlocksOfBin = 20;
// The share of a bin's blocks that is assumed flat. Its largest variance lies
// below the noise's by this quantile of the dispersion of normal noise.
constexpr double kFlatShare = 0.1;
constexpr double kFlatQuantile = -1.2816;
// The cost of a bin above the curve; one below it costs 1 minus this, since in
// some bins no block is flat.
constexpr double kCostAbove = 0.2;

struct Bin {
  double level = 0.0;
  double variance = 0.0;
  double weight = 0.0;
};

std::vector<Bin> FlattestOfEachBin(const std::vector<BlockStatistics>& blocks) {
  std::vector<std::vector<BlockStatistics>> members(kNumBins);
  for (const BlockStatistics& block : blocks) {
    if (block.mean >= kMinLevel && block.mean <= kMaxLevel) {
      members[static_cast<size_t>(block.mean) * kNumBins / 256].push_back(
          block);
    }
  }
  const double scatter = std::sqrt(2.0 / kDegreesOfFreedom);
  std::vector<Bin> bins;
  for (std::vector<BlockStatistics>& of_bin : members) {
    if (of_bin.size() < kMinBlocksOfBin) {
      continue;
    }
    const auto last_flat =
        of_bin.begin() +
        static_cast<std::ptrdiff_t>(kFlatShare *
                                    static_cast<double>(of_bin.size() - 1));
    std::nth_element(of_bin.begin(),
                     last_flat,
                     of_bin.end(),
                     [](const BlockStatistics& a, const BlockStatistics& b) {
                       return a.variance < b.variance;
                     });
    Bin bin;
    for (const BlockStatistics& block : of_bin) {
      bin.level += block.mean;
    }
    bin.level /= static_cast<double>(of_bin.size());
    bin.variance =
        std::max(last_flat->variance / (1.0 + kFlatQuantile * scatter),
                 kQuantizationVariance);
    // Large bins do not outvote all others.
    bin.weight = std::sqrt(static_cast<double>(of_bin.size()));
    bins.push_back(bin);
  }
  return bins;
}

// The cost of a curve (an asymmetric loss of log ratios): the variances of
// textured bins exceed the noise's by orders of magnitude.
double Cost(const std::vector<Bin>& bins, double constant, double per_level) {
  double cost = 0.0;
  for (const Bin& bin : bins) {
    const double ratio =
        std::log(bin.variance / (constant + per_level * bin.level));
    cost += bin.weight *
            (ratio > 0.0 ? kCostAbove * ratio : (kCostAbove - 1.0) * ratio);
  }
  return cost;
}

}  // namespace

NoiseCurve EstimateNoise(ImageView<const float> gray, Device& device) {
  DeviceImage<BlockStatistics> blocks(
      device, gray.width / kBlock, gray.height / kBlock);
  ParallelFor(device,
              blocks.Width(),
              blocks.Height(),
              BlockKernel{gray, blocks.View()});
  const Image<BlockStatistics> on_host = blocks.ToHost();
  return FitNoiseCurve({on_host.begin(), on_host.end()});
}

NoiseCurve FitNoiseCurve(const std::vector<BlockStatistics>& blocks) {
  const std::vector<Bin> bins = FlattestOfEachBin(blocks);
  double constant = kQuantizationVariance;
  double per_level = 0.0;
  double least = Cost(bins, constant, per_level);
  const auto consider = [&](double a, double b) {
    if (a < kQuantizationVariance || b < 0.0) {
      return;
    }
    const double cost = Cost(bins, a, b);
    if (cost < least) {
      least = cost;
      constant = a;
      per_level = b;
    }
  };
  // A line of least cost passes through two bins, or through one where it meets
  // a bound.
  for (const Bin& bin : bins) {
    consider(bin.variance, 0.0);
    consider(kQuantizationVariance,
             (bin.variance - kQuantizationVariance) / bin.level);
    for (const Bin& other : bins) {
      if (other.level > bin.level) {
        const double slope =
            (other.variance - bin.variance) / (other.level - bin.level);
        consider(bin.variance - slope * bin.level, slope);
      }
    }
  }
  return {static_cast<float>(constant), static_cast<float>(per_level)};
}

}  // namespace tsar
