// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/noise/noise_curve.h"

#include <cmath>

#include "tests/noise/drawn_noise.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kDegreesOfFreedom = 61;
// Of rounding to whole levels.
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
    ExpectCurve(
        FitNoiseCurve(DrawBlocks(curve, 8000, 10.f, 245.f), kDegreesOfFreedom),
        curve);
  }
}

TEST(FitNoiseCurve, StaysBelowTexturedBlocks) {
  const NoiseCurve curve{2.f, 0.05f};
  std::vector<BlockStatistics> blocks = DrawBlocks(curve, 8000, 10.f, 245.f);
  for (size_t i = 0; i < blocks.size(); i += 2) {
    blocks[i].variance += 100.f + 10.f * static_cast<float>(i % 7);
  }
  const NoiseCurve fitted = FitNoiseCurve(blocks, kDegreesOfFreedom);
  for (const float level : {20.f, 128.f, 240.f}) {
    // Its tenth part of the flattest blocks is a fifth of those without
    // texture.
    EXPECT_NEAR(fitted.Variance(level) / curve.Variance(level), 1.f, 0.15f);
  }
}

TEST(FitNoiseCurve, StaysBelowMostLevelsWithoutFlatBlocks) {
  const NoiseCurve curve{2.f, 0.05f};
  std::vector<BlockStatistics> blocks = DrawBlocks(curve, 8000, 10.f, 245.f);
  for (BlockStatistics& block : blocks) {
    if (block.mean > 80.f && block.mean < 224.f) {
      block.variance += 300.f;
    }
  }
  ExpectCurve(FitNoiseCurve(blocks, kDegreesOfFreedom), curve);
}

TEST(FitNoiseCurve, IgnoresClippedBlocks) {
  const NoiseCurve curve{9.f, 0.f};
  std::vector<BlockStatistics> blocks = DrawBlocks(curve, 2000, 30.f, 220.f);
  for (int i = 0; i < 5000; ++i) {
    blocks.push_back({2.f, 0.f});
    blocks.push_back({254.f, 0.f});
  }
  ExpectCurve(FitNoiseCurve(blocks, kDegreesOfFreedom), curve);
}

TEST(FitNoiseCurve, WithoutBlocksIsThatOfRounding) {
  const std::vector<std::vector<BlockStatistics>> cases = {
      {},
      // Too few to tell.
      DrawBlocks({9.f, 0.f}, 19, 100.f, 100.f),
      std::vector<BlockStatistics>(1000, {255.f, 9.f})};
  for (const std::vector<BlockStatistics>& blocks : cases) {
    const NoiseCurve curve = FitNoiseCurve(blocks, kDegreesOfFreedom);
    EXPECT_EQ(curve.constant, kLeastVariance);
    EXPECT_EQ(curve.per_level, 0.f);
  }
}

TEST(FitNoiseCurve, NeverFallsWithTheLightNorBelowRounding) {
  // Compressed highlights have less noise.
  std::vector<BlockStatistics> blocks =
      DrawBlocks({9.f, 0.f}, 4000, 10.f, 99.f);
  const std::vector<BlockStatistics> bright =
      DrawBlocks({1.f, 0.f}, 4000, 101.f, 245.f);
  blocks.insert(blocks.end(), bright.begin(), bright.end());
  const NoiseCurve curve = FitNoiseCurve(blocks, kDegreesOfFreedom);
  EXPECT_GE(curve.per_level, 0.f);
  EXPECT_GE(curve.constant, kLeastVariance);
  EXPECT_GE(FitNoiseCurve(DrawBlocks({0.f, 0.f}, 4000, 10.f, 245.f),
                          kDegreesOfFreedom)
                .constant,
            kLeastVariance);
}

}  // namespace
}  // namespace tsar
