// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/matching_cost.h"

#include <algorithm>

#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kBaseline = 0.3;

struct HostCosts {
  Image<float> min;
  Image<float> second;
  Image<float> difference;
};

class MatchingCostTest : public testing::Test {
 protected:
  MatchingCostTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(72, 48, 100.0)),
        scene_(DrawnPlane({0.4f, -0.2f, -1.f}, 3.f), camera_, *device_) {}

  void AddSource(double x, double angle) {
    scene_.AddSource(SourceCamera(camera_, {x, 0.02, 0.01}, angle));
  }
  HostCosts Compute() {
    const MatchingCosts costs =
        ComputeMatchingCosts(scene_.Reference(), scene_.Sources(), *device_);
    return {costs.min_cost.ToHost(),
            costs.second_cost.ToHost(),
            costs.left_right_difference.ToHost()};
  }
  // Moves each depth by this many pixels of disparity.
  void ShiftDepth(float pixels) {
    const float factor = static_cast<float>(camera_.fx * kBaseline);
    for (float& depth : scene_.Depth()) {
      depth = factor / (factor / depth + pixels);
    }
  }
  static float MeanDefined(const Image<float>& costs) {
    float sum = 0.f;
    int count = 0;
    for (const float cost : costs) {
      if (cost != kUndefinedCost) {
        sum += cost;
        ++count;
      }
    }
    EXPECT_GT(count, static_cast<int>(costs.NumPixels() / 2));
    return sum / count;
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  TexturedPlane scene_;
};

TEST_F(MatchingCostTest, IsSmallAtTheTruthAndGrowsWithTheError) {
  AddSource(kBaseline, 0.05);
  AddSource(-kBaseline, -0.05);
  const Image<float> truth =
      DrawDepth(DrawnPlane({0.4f, -0.2f, -1.f}, 3.f), camera_);
  const float at_truth = MeanDefined(Compute().min);
  EXPECT_LT(at_truth, 0.05f);
  for (const float pixels : {-2.f, -1.f, 1.f, 2.f}) {
    scene_.Depth() = truth;
    ShiftDepth(pixels);
    EXPECT_GT(MeanDefined(Compute().min), at_truth + 0.1f) << pixels;
  }
}

TEST_F(MatchingCostTest, DoesNotDependOnTheOrderOfTheSources) {
  AddSource(kBaseline, 0.05);
  AddSource(-kBaseline, -0.05);
  ShiftDepth(0.7f);
  TexturedPlane reversed(
      DrawnPlane({0.4f, -0.2f, -1.f}, 3.f), camera_, *device_);
  reversed.AddSource(SourceCamera(camera_, {-kBaseline, 0.02, 0.01}, -0.05));
  reversed.AddSource(SourceCamera(camera_, {kBaseline, 0.02, 0.01}, 0.05));
  reversed.Depth() = scene_.Depth();
  const HostCosts costs = Compute();
  const MatchingCosts others =
      ComputeMatchingCosts(reversed.Reference(), reversed.Sources(), *device_);
  const Image<float> other_min = others.min_cost.ToHost();
  const Image<float> other_second = others.second_cost.ToHost();
  EXPECT_TRUE(
      std::equal(costs.min.begin(), costs.min.end(), other_min.begin()));
  EXPECT_TRUE(std::equal(
      costs.second.begin(), costs.second.end(), other_second.begin()));
}

TEST_F(MatchingCostTest, LooksTheSameFromTheOtherSideAtTheTruth) {
  AddSource(kBaseline, 0.05);
  const HostCosts costs = Compute();
  float sum = 0.f;
  int count = 0;
  ForEachPixel(20, 64, 8, 40, [&](int x, int y) {
    if (costs.min(x, y) != kUndefinedCost) {
      sum += costs.difference(x, y);
      ++count;
    }
  });
  ASSERT_GT(count, 500);
  EXPECT_LT(sum / count, 0.05f);
}

TEST_F(MatchingCostTest, IsUndefinedWhereASourceSeesNothing) {
  // One source looks away; one is so far away that the views share nothing.
  AddSource(kBaseline, 3.1);
  AddSource(50.0, 0.0);
  const HostCosts costs = Compute();
  for (const float cost : costs.min) {
    ASSERT_EQ(cost, kUndefinedCost);
  }
}

TEST_F(MatchingCostTest, IsUndefinedWithoutTextureOrDepth) {
  AddSource(kBaseline, 0.05);
  scene_.Depth()(36, 24) = 0.f;
  Image<float>& gray = scene_.Gray();
  ForEachPixel(50, camera_.width, 0, camera_.height, [&](int x, int y) {
    gray(x, y) = 200.f;
  });
  const HostCosts costs = Compute();
  EXPECT_EQ(costs.min(36, 24), kUndefinedCost);
  EXPECT_NE(costs.min(37, 24), kUndefinedCost);
  EXPECT_EQ(costs.min(60, 24), kUndefinedCost);
}

}  // namespace
}  // namespace tsar
