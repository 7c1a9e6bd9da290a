// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/noise/estimate_noise.h"

#include <cmath>

#include "tests/noise/drawn_noise.h"
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
  const auto device = Device::CreateCpu(2);
  return EstimateNoise(gray.View(), *device);
}

TEST(EstimateNoise, MeasuresItBesideGradientsAndTexture) {
  for (const double sigma : {1.0, 2.0, 4.0, 8.0}) {
    NormalNoise noise(1);
    Image<float> gray(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        gray(x, y) = ToLevel(CleanLevel(x, y) + sigma * noise.Next());
      }
    }
    EXPECT_NEAR(std::sqrt(Estimate(gray).Variance(128.f)), sigma, 0.15 * sigma);
  }
}

TEST(EstimateNoise, GrowsWithTheLight) {
  NormalNoise noise(2);
  Image<float> gray(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double level = 30.0 + 0.4 * x;
      gray(x, y) = ToLevel(level + std::sqrt(0.1 * level) * noise.Next());
    }
  }
  const NoiseCurve curve = Estimate(gray);
  EXPECT_NEAR(curve.Variance(50.f), 5.f, 1.5f);
  EXPECT_NEAR(curve.Variance(200.f), 20.f, 3.f);
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
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      double sum = 0.0;
      for (int v = 0; v < 3; ++v) {
        for (int u = 0; u < 3; ++u) {
          sum += drawn(x + u, y + v);
        }
      }
      gray(x, y) = ToLevel(CleanLevel(x, y) + sum / 9.0);
    }
  }
  EXPECT_NEAR(std::sqrt(Estimate(gray).Variance(128.f)), 3.0, 0.6);
}

TEST(EstimateNoise, DoesNotTakeSmoothTextureForIt) {
  // Waves of six to fifteen pixels everywhere, of a standard deviation of 38.
  Image<float> gray(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      gray(x, y) = ToLevel(128.0 + 40.0 * std::sin(0.9 * x + 0.2 * y) +
                           30.0 * std::sin(0.61 * y - 0.35 * x + 1.0) +
                           20.0 * std::sin(0.43 * x + 0.47 * y + 2.0));
    }
  }
  EXPECT_LT(std::sqrt(Estimate(gray).Variance(128.f)), 15.f);
}

TEST(EstimateNoise, ConstantImageHasThatOfRounding) {
  for (const auto& [width, height] :
       {std::pair(200, 200), std::pair(1, 1), std::pair(7, 300)}) {
    const NoiseCurve curve = Estimate(Image<float>(width, height, 128.f));
    EXPECT_EQ(curve.constant, 1.f / 12.f);
    EXPECT_EQ(curve.per_level, 0.f);
  }
}

}  // namespace
}  // namespace tsar
