// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/observed_source.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 90;
constexpr float kDepth = 4.f;

// A wall of random colors that two views 0.8 apart see, each darker towards
// its corners.
class ColorGainTest : public testing::Test {
 protected:
  ColorGainTest() {
    camera_.width = kWidth;
    camera_.height = kHeight;
    camera_.fx = camera_.fy = 100.0;
    camera_.cx = 0.5 * (kWidth - 1);
    camera_.cy = 0.5 * (kHeight - 1);
  }

  // shift: of the wall, in pixels, to the left.
  ViewEvidence Draw(int shift, const Vec3f& balance, float falloff) const {
    ViewEvidence evidence;
    evidence.width = kWidth;
    evidence.height = kHeight;
    evidence.confident_depth = Image<float>(kWidth, kHeight, kDepth);
    evidence.color = Image<Rgb>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        Philox random(
            static_cast<uint32_t>(x + shift), static_cast<uint32_t>(y), 0);
        const float gray = 90.f + 60.f * random.NextFloat();
        const float light = 1.f - falloff * SquaredRadius(static_cast<float>(x),
                                                          static_cast<float>(y),
                                                          kWidth,
                                                          kHeight);
        const auto level = [&](float of_channel) {
          return static_cast<uint8_t>(std::lround(gray * light * of_channel));
        };
        evidence.color(x, y) = {
            level(balance.x), level(balance.y), level(balance.z)};
      }
    }
    return evidence;
  }

  ColorGain Estimate(const ViewEvidence& reference,
                     const ViewEvidence& source) const {
    Camera moved = camera_;
    moved.translation.x() -= 0.8;
    return EstimateColorGain({&reference, camera_}, {&source, moved});
  }

  Camera camera_;
};

TEST_F(ColorGainTest, FindsExposureAndWhiteBalance) {
  const ColorGain gain = Estimate(Draw(0, {1.f, 1.f, 1.f}, 0.f),
                                  Draw(20, {1.25f, 1.f, 0.8f}, 0.f));
  EXPECT_NEAR(gain.balance.x, 0.8f, 0.01f);
  EXPECT_NEAR(gain.balance.y, 1.f, 0.01f);
  EXPECT_NEAR(gain.balance.z, 1.25f, 0.01f);
  EXPECT_NEAR(gain.falloff, 0.f, 0.02f);
}

TEST_F(ColorGainTest, FindsTheFalloffTowardsTheCorners) {
  const ColorGain gain =
      Estimate(Draw(0, {1.f, 1.f, 1.f}, 0.3f), Draw(20, {1.f, 1.f, 1.f}, 0.3f));
  EXPECT_NEAR(gain.balance.y, 1.f, 0.02f);
  EXPECT_NEAR(gain.falloff, 0.33f, 0.06f);
}

TEST_F(ColorGainTest, IsNoneWhereTheViewsShareNothing) {
  ViewEvidence empty = Draw(20, {1.25f, 1.f, 0.8f}, 0.f);
  empty.confident_depth = Image<float>(kWidth, kHeight);
  const ColorGain gain = Estimate(Draw(0, {1.f, 1.f, 1.f}, 0.f), empty);
  EXPECT_EQ(gain.balance, (Vec3f{1.f, 1.f, 1.f}));
  EXPECT_EQ(gain.falloff, 0.f);
}

}  // namespace
}  // namespace tsar
