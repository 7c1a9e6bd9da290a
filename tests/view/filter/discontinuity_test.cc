// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/discontinuity.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

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
    return ComputeDiscontinuity(
               DeviceCopies(*device_)(depth), scale_, {}, *device_)
        .ToHost();
  }
  static void ExpectEverywhere(const Image<float>& score, float expected) {
    for (int y = 0; y < score.Height(); ++y) {
      for (int x = 0; x < score.Width(); ++x) {
        ASSERT_FLOAT_EQ(score(x, y), expected) << x << ", " << y;
      }
    }
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

TEST_F(DiscontinuityTest, IsZeroOnNoise) {
  Image<float> depth(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      depth(x, y) = 2.f + 0.5f * ((x * 7 + y * 13) % 11);
    }
  }
  const Image<float> score = Score(depth);
  const float mean =
      std::accumulate(score.begin(), score.end(), 0.f) / score.NumPixels();
  EXPECT_LT(mean, 0.2f * kFullScore);
}

// Both sides of a depth edge are large surfaces, wherever the edge lies with
// respect to the blocks of the layers.
TEST_F(DiscontinuityTest, ErodesNeitherSideOfAStep) {
  for (int step = 80; step < 88; ++step) {
    Image<float> vertical(168, 128, 5.f);
    Image<float> horizontal(128, 168, 5.f);
    for (int y = 0; y < 128; ++y) {
      for (int x = step; x < 168; ++x) {
        vertical(x, y) = 4.f;
        horizontal(y, x) = 4.f;
      }
    }
    SCOPED_TRACE(step);
    ExpectEverywhere(Score(vertical), kFullScore);
    ExpectEverywhere(Score(horizontal), kFullScore);
  }
}

TEST_F(DiscontinuityTest, DoesNotDependOnTheScenesScale) {
  Image<float> depth = DrawDepth(DrawnPlane({1.f, 0.5f, -1.f}, 5.f), camera_);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      depth(x, y) *= (x / 9 + y / 5) % 3 == 0 ? 0.8f : 1.f;
    }
  }
  const Image<float> score = Score(depth);
  // A power of two, so that not even rounding differs.
  for (float& z : depth) {
    z *= 1024.f;
  }
  scale_.factor *= 1024.f;
  const Image<float> scaled = Score(depth);
  EXPECT_TRUE(std::equal(score.begin(), score.end(), scaled.begin()));
}

TEST_F(DiscontinuityTest, CountsOnlyTheLayersItIsGiven) {
  DiscontinuityOptions options;
  const Image<float> depth(64, 48, 5.f);
  for (const auto& [num_layers, expected] :
       std::vector<std::pair<int, float>>{{0, 0.f}, {1, 1.f}, {2, 1.5f}}) {
    options.num_layers = num_layers;
    ExpectEverywhere(
        ComputeDiscontinuity(
            DeviceCopies(*device_)(depth), scale_, options, *device_)
            .ToHost(),
        expected);
  }
}

}  // namespace
}  // namespace tsar
