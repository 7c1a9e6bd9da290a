// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/texture_measures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 20;
constexpr int kHeight = 15;

Image<float> Draw(const std::function<float(int x, int y)>& level,
                  int width = kWidth,
                  int height = kHeight) {
  Image<float> gray(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      gray(x, y) = level(x, y);
    }
  }
  return gray;
}

class TextureMeasuresTest : public testing::Test {
 protected:
  Image<float> Texture(const Image<float>& gray) const {
    return ComputeTexture(DeviceImage<float>(*device_, gray).View(), *device_)
        .ToHost();
  }

  Image<float> Contrast(const Image<float>& gray) const {
    return ComputeContrast(DeviceImage<float>(*device_, gray).View(), *device_)
        .ToHost();
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(2);
};

TEST_F(TextureMeasuresTest, IsZeroWhereNothingVaries) {
  const Image<float> gray(kWidth, kHeight, 171.3f);
  for (const Image<float>& result : {Texture(gray), Contrast(gray)}) {
    EXPECT_EQ(result.Width(), kWidth);
    EXPECT_EQ(result.Height(), kHeight);
    EXPECT_EQ(std::count(result.begin(), result.end(), 0.f), kWidth * kHeight);
  }
}

TEST_F(TextureMeasuresTest, OfACheckerboardIsHalfItsStep) {
  const Image<float> gray =
      Draw([](int x, int y) { return (x + y) % 2 == 0 ? 50.f : 150.f; });
  const Image<float> texture = Texture(gray);
  // 24 of 49 pixels are of one kind, in the corner 8 of 16.
  EXPECT_NEAR(texture(10, 7), 100.f * std::sqrt(24.f * 25.f) / 49.f, 1e-3f);
  EXPECT_NEAR(texture(0, 0), 50.f, 1e-3f);
  for (const float contrast : Contrast(gray)) {
    EXPECT_EQ(contrast, 100.f);
  }
}

TEST_F(TextureMeasuresTest, SpansSevenPixelsOrThoseInTheImage) {
  const Image<float> texture =
      Texture(Draw([](int x, int) { return static_cast<float>(x); }));
  EXPECT_NEAR(texture(10, 7), 2.f, 1e-4f);
  EXPECT_NEAR(texture(10, 0), 2.f, 1e-4f);
  EXPECT_NEAR(texture(3, 7), 2.f, 1e-4f);
  EXPECT_NEAR(texture(0, 7), std::sqrt(1.25f), 1e-4f);
  EXPECT_NEAR(texture(kWidth - 1, kHeight - 1), std::sqrt(1.25f), 1e-4f);
  const Image<float> downwards =
      Texture(Draw([](int, int y) { return static_cast<float>(y); }));
  EXPECT_NEAR(downwards(10, 7), 2.f, 1e-4f);
  EXPECT_NEAR(downwards(10, kHeight - 1), std::sqrt(1.25f), 1e-4f);
}

TEST_F(TextureMeasuresTest, ContrastReachesOnePixelInAllDirections) {
  for (const float level : {20.f, 90.f}) {
    const Image<float> contrast = Contrast(
        Draw([&](int x, int y) { return x == 8 && y == 0 ? level : 50.f; }));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        EXPECT_EQ(
            contrast(x, y),
            y <= 1 && std::abs(x - 8) <= 1 ? std::abs(level - 50.f) : 0.f);
      }
    }
  }
}

TEST_F(TextureMeasuresTest, TakesTinyImages) {
  const Image<float> one(1, 1, 77.f);
  EXPECT_EQ(Texture(one)(0, 0), 0.f);
  EXPECT_EQ(Contrast(one)(0, 0), 0.f);
  const Image<float> row =
      Draw([](int x, int) { return static_cast<float>(2 * x); }, 2, 1);
  EXPECT_NEAR(Texture(row)(0, 0), 1.f, 1e-5f);
  EXPECT_EQ(Contrast(row)(1, 0), 2.f);
  EXPECT_TRUE(Texture({}).Empty());
  EXPECT_TRUE(Contrast({}).Empty());
}

}  // namespace
}  // namespace tsar
