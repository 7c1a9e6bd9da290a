// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/denoise/estimate_noise.h"

#include <cmath>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include "tests/view/denoise/drawn_noise.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 480;
constexpr int kHeight = 360;

// A gradient over most of the range; the third on the right is textured.
double CleanLevel(int x, int y) {
  const double gradient = 60.0 + 0.2 * x + 0.1 * y;
  return x < 2 * kWidth / 3
             ? gradient
             : gradient + 20.0 * std::sin(0.9 * x) + 20.0 * std::sin(1.3 * y);
}

NoiseCurve Estimate(const Image<float>& gray) {
  const auto device = CreateTestDevice(2);
  return EstimateNoise(DeviceCopies(*device)(gray), *device);
}

TEST(EstimateNoise, MeasuresItBesideGradientsAndTexture) {
  for (const double sigma : {1.0, 2.0, 4.0, 8.0}) {
    NormalNoise noise(1);
    Image<float> gray(kWidth, kHeight);
    ForEachPixel(kWidth, kHeight, [&](int x, int y) {
      gray(x, y) = ToLevel(CleanLevel(x, y) + sigma * noise.Next());
    });
    EXPECT_NEAR(std::sqrt(Estimate(gray).Variance(128.f)), sigma, 0.15 * sigma);
  }
}

TEST(EstimateNoise, MeasuresCorrelatedNoise) {
  // As compression and resizing leave it. Differences of adjacent pixels would
  // show 58 % of it.
  NormalNoise noise(3);
  Image<double> drawn(kWidth + 2, kHeight + 2);
  for (double& value : drawn) {
    value = 9.0 * noise.Next();
  }
  Image<float> gray(kWidth, kHeight);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    double sum = 0.0;
    for (int v = 0; v < 3; ++v) {
      for (int u = 0; u < 3; ++u) {
        sum += drawn(x + u, y + v);
      }
    }
    gray(x, y) = ToLevel(CleanLevel(x, y) + sum / 9.0);
  });
  EXPECT_NEAR(std::sqrt(Estimate(gray).Variance(128.f)), 3.0, 0.6);
}

TEST(EstimateNoise, DoesNotTakeSmoothTextureForIt) {
  // Waves of six to fifteen pixels everywhere, of a standard deviation of 38.
  Image<float> gray(kWidth, kHeight);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    gray(x, y) = ToLevel(128.0 + 40.0 * std::sin(0.9 * x + 0.2 * y) +
                         30.0 * std::sin(0.61 * y - 0.35 * x + 1.0) +
                         20.0 * std::sin(0.43 * x + 0.47 * y + 2.0));
  });
  EXPECT_LT(std::sqrt(Estimate(gray).Variance(128.f)), 15.f);
}

constexpr int kDegreesOfFreedom = 61;
// The variance of rounding to whole levels.
constexpr float kLeastVariance = 1.f / 12.f;

// Blocks whose brightness runs from one level to another, with variances as
// they scatter about the curve.
std::vector<BlockStatistics> DrawBlocks(const NoiseCurve& curve,
                                        int count,
                                        float from,
                                        float to) {
  NormalNoise noise(7);
  std::vector<BlockStatistics> blocks;
  for (int i = 0; i < count; ++i) {
    const float mean =
        from + (to - from) * static_cast<float>(i) / static_cast<float>(count);
    double squares = 0.0;
    for (int k = 0; k < kDegreesOfFreedom; ++k) {
      squares += std::pow(noise.Next(), 2);
    }
    blocks.push_back({mean,
                      curve.Variance(mean) *
                          static_cast<float>(squares / kDegreesOfFreedom)});
  }
  return blocks;
}

void ExpectCurve(const NoiseCurve& curve, const NoiseCurve& expected) {
  for (const float level : {20.f, 128.f, 240.f}) {
    EXPECT_NEAR(curve.Variance(level),
                expected.Variance(level),
                0.1f * expected.Variance(level))
        << level;
  }
}

TEST(FitNoiseCurve, FindsTheCurveOfFlatBlocks) {
  for (const NoiseCurve& curve :
       {NoiseCurve{4.f, 0.f}, NoiseCurve{1.f, 0.1f}, NoiseCurve{20.f, 0.3f}}) {
    SCOPED_TRACE(curve.per_level);
    ExpectCurve(FitNoiseCurve(DrawBlocks(curve, 8000, 10.f, 245.f)), curve);
  }
}

TEST(FitNoiseCurve, StaysBelowTexturedBlocks) {
  const NoiseCurve curve{2.f, 0.05f};
  std::vector<BlockStatistics> blocks = DrawBlocks(curve, 8000, 10.f, 245.f);
  for (size_t i = 0; i < blocks.size(); i += 2) {
    blocks[i].variance += 100.f + 10.f * static_cast<float>(i % 7);
  }
  const NoiseCurve fitted = FitNoiseCurve(blocks);
  for (const float level : {20.f, 128.f, 240.f}) {
    // Its flattest tenth of the blocks is a fifth of those without texture.
    EXPECT_NEAR(fitted.Variance(level) / curve.Variance(level), 1.f, 0.15f);
  }
}

TEST(FitNoiseCurve, IgnoresClippedBlocks) {
  const NoiseCurve curve{9.f, 0.f};
  std::vector<BlockStatistics> blocks = DrawBlocks(curve, 2000, 30.f, 220.f);
  for (int i = 0; i < 5000; ++i) {
    blocks.push_back({2.f, 0.f});
    blocks.push_back({254.f, 0.f});
  }
  ExpectCurve(FitNoiseCurve(blocks), curve);
}

TEST(FitNoiseCurve, NeverFallsWithTheLightNorBelowRounding) {
  // Compressed highlights have less noise.
  std::vector<BlockStatistics> blocks =
      DrawBlocks({9.f, 0.f}, 4000, 10.f, 99.f);
  const std::vector<BlockStatistics> bright =
      DrawBlocks({1.f, 0.f}, 4000, 101.f, 245.f);
  blocks.insert(blocks.end(), bright.begin(), bright.end());
  const NoiseCurve curve = FitNoiseCurve(blocks);
  EXPECT_GE(curve.per_level, 0.f);
  EXPECT_GE(curve.constant, kLeastVariance);
  EXPECT_GE(FitNoiseCurve(DrawBlocks({0.f, 0.f}, 4000, 10.f, 245.f)).constant,
            kLeastVariance);
}

}  // namespace
}  // namespace tsar
