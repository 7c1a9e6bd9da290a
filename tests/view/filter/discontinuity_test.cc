// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/discontinuity.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kFullScore = 11.f / 6.f;

class DiscontinuityTest : public testing::Test {
 protected:
  DiscontinuityTest()
      : device_(CreateTestDevice(2)), camera_(SyntheticCamera(64, 48, 60.0)) {
    scale_.factor = 1000.f;
  }

  Image<float> Score(const Image<float>& depth) const {
    return ComputeDiscontinuity(DeviceCopies(*device_)(depth), scale_, *device_)
        .ToHost();
  }
  static void ExpectEverywhere(const Image<float>& score, float expected) {
    ForEachPixel(score.Width(), score.Height(), [&](int x, int y) {
      ASSERT_FLOAT_EQ(score(x, y), expected) << x << ", " << y;
    });
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  DisparityScale scale_;
};

TEST_F(DiscontinuityTest, IsFullOnASlantedPlane) {
  const Image<float> depth =
      DrawDepth(DrawnPlane({1.f, 0.5f, -1.f}, 5.f), camera_);
  // More than the largest step from one border to the other, less than it
  // between neighbors.
  const auto [near, far] = std::minmax_element(depth.begin(), depth.end());
  ASSERT_GT(scale_.ToDisparity(*near) - scale_.ToDisparity(*far), 24.f);
  ExpectEverywhere(Score(depth), kFullScore);
}

TEST_F(DiscontinuityTest, IsZeroOnIsolatedSpecks) {
  Image<float> depth(64, 48, 5.f);  // 200 pixels of disparity
  const std::vector<std::pair<int, int>> specks = {
      {3, 3}, {20, 9}, {31, 30}, {47, 16}, {0, 0}, {63, 47}};
  for (const auto& [x, y] : specks) {
    depth(x, y) = 4.f;
  }
  const Image<float> score = Score(depth);
  for (const auto& [x, y] : specks) {
    EXPECT_EQ(score(x, y), 0.f) << x << ", " << y;
  }
  EXPECT_FLOAT_EQ(score(40, 40), kFullScore);
}

// Both sides of a depth edge are large surfaces, wherever the edge lies with
// respect to the blocks of the layers.
TEST_F(DiscontinuityTest, ErodesNeitherSideOfAStep) {
  for (int step = 80; step < 88; ++step) {
    Image<float> vertical(168, 128, 5.f);
    Image<float> horizontal(128, 168, 5.f);
    ForEachPixel(step, 168, 0, 128, [&](int x, int y) {
      vertical(x, y) = 4.f;
      horizontal(y, x) = 4.f;
    });
    SCOPED_TRACE(step);
    ExpectEverywhere(Score(vertical), kFullScore);
    ExpectEverywhere(Score(horizontal), kFullScore);
  }
}

TEST_F(DiscontinuityTest, DoesNotDependOnTheScenesScale) {
  Image<float> depth = DrawDepth(DrawnPlane({1.f, 0.5f, -1.f}, 5.f), camera_);
  ForEachPixel(64, 48, [&](int x, int y) {
    depth(x, y) *= (x / 9 + y / 5) % 3 == 0 ? 0.8f : 1.f;
  });
  const Image<float> score = Score(depth);
  // A power of two, so that not even rounding differs.
  for (float& z : depth) {
    z *= 1024.f;
  }
  scale_.factor *= 1024.f;
  const Image<float> scaled = Score(depth);
  EXPECT_TRUE(std::equal(score.begin(), score.end(), scaled.begin()));
}

}  // namespace
}  // namespace tsar
