// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/tools/stereo/planar_prior.h"

#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "tests/support/synthetic_views.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 6;
constexpr int kHeight = 4;
const Intrinsics kIntrinsics{10.f, 10.f, 3.f, 2.f};

StereoMaps EmptyMaps() {
  return {Image<float>(kWidth, kHeight),
          Image<Vec3f>(kWidth, kHeight),
          Image<float>(kWidth, kHeight, kCostWithoutEvidence),
          Image<float>(kWidth, kHeight, kCostWithoutEvidence)};
}

// A wall that faces the camera.
Image<Plane> Wall(float depth) {
  return Image<Plane>(kWidth, kHeight, Plane{{0.f, 0.f, -1.f}, depth});
}

TEST(FillWithPrior, GivesEmptyPixelsTheirPlanesDepthAndAMark) {
  StereoMaps maps = EmptyMaps();
  maps.depth(2, 1) = 2.5f;
  maps.normal(2, 1) = {0.6f, 0.f, -0.8f};
  maps.min_cost(2, 1) = 0.25f;
  maps.second_cost(2, 1) = 0.5f;
  Image<Plane> prior = Wall(3.f);
  prior(4, 2) = {};
  FillWithPrior(prior, kIntrinsics, {1.0, 5.0}, &maps);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x == 2 && y == 1) {
        EXPECT_EQ(maps.depth(x, y), 2.5f);
        EXPECT_EQ(maps.normal(x, y).x, 0.6f);
        EXPECT_EQ(maps.min_cost(x, y), 0.25f);
        EXPECT_EQ(maps.second_cost(x, y), 0.5f);
      } else {
        const bool has_prior = x != 4 || y != 2;
        EXPECT_EQ(maps.depth(x, y), has_prior ? 3.f : 0.f) << x << ", " << y;
        EXPECT_EQ(maps.normal(x, y).z, has_prior ? -1.f : 0.f);
        const float cost = has_prior ? kUndefinedCost : kCostWithoutEvidence;
        EXPECT_EQ(maps.min_cost(x, y), cost);
        EXPECT_EQ(maps.second_cost(x, y), cost);
      }
    }
  }
}

TEST(FillWithPrior, StaysWithinTheRange) {
  for (const float depth :
       {0.9f, 5.1f, std::numeric_limits<float>::infinity()}) {
    StereoMaps maps = EmptyMaps();
    FillWithPrior(Wall(depth), kIntrinsics, {1.0, 5.0}, &maps);
    for (const float filled : maps.depth) {
      EXPECT_EQ(filled, 0.f) << depth;
    }
  }
}

class MatchUnderPriorTest : public testing::Test {
 protected:
  // Of the first view, every second pixel is said to be measured: some of them
  // without a defined cost, as those whose window has no texture.
  MatchUnderPriorTest() : drawn_(MakeSyntheticViews({})) {
    options_.num_iterations = 1;
    for (ViewData& view : drawn_.views) {
      const int width = view.depth.Width();
      view.min_cost = Image<float>(width, view.depth.Height(), kUndefinedCost);
      for (size_t i = 0; i < view.depth.NumPixels(); ++i) {
        if (!(view.depth.Data()[i] > 0.f)) {
          view.min_cost.Data()[i] = kCostWithoutEvidence;
        } else if (i % 2 == 0) {
          view.min_cost.Data()[i] = i % 4 == 0 ? 0.1f : kCostWithoutEvidence;
        }
      }
      view.second_cost = view.min_cost;
    }
  }

  StereoMaps Match(int num_threads = 2) {
    std::vector<const ViewData*> sources;
    for (size_t i = 1; i < drawn_.views.size(); ++i) {
      sources.push_back(&drawn_.views[i]);
    }
    const auto device = Device::CreateCpu(num_threads);
    return MatchUnderPrior(
        drawn_.views[0], sources, {2.0, 10.0}, 1, options_, *device);
  }

  bool IsMeasured(size_t pixel) const {
    return drawn_.views[0].min_cost.Data()[pixel] != kUndefinedCost;
  }

  SyntheticViews drawn_;
  StereoOptions options_;
};

TEST_F(MatchUnderPriorTest, LeavesWhatWasMeasuredBitForBit) {
  const ViewData& before = drawn_.views[0];
  const StereoMaps after = Match();
  int num_measured = 0;
  int num_filled = 0;
  for (size_t i = 0; i < before.depth.NumPixels(); ++i) {
    if (IsMeasured(i)) {
      ++num_measured;
      ASSERT_EQ(after.depth.Data()[i], before.depth.Data()[i]);
      ASSERT_EQ(
          std::memcmp(
              &after.normal.Data()[i], &before.normal.Data()[i], sizeof(Vec3f)),
          0);
      ASSERT_EQ(after.min_cost.Data()[i], before.min_cost.Data()[i]);
    } else {
      ASSERT_EQ(after.min_cost.Data()[i], kCostWithoutEvidence);
      ASSERT_EQ(after.second_cost.Data()[i], kCostWithoutEvidence);
      num_filled += after.depth.Data()[i] > 0.f ? 1 : 0;
    }
  }
  EXPECT_GT(num_measured, 100);
  EXPECT_GT(num_filled, 100);
}

TEST_F(MatchUnderPriorTest, FillsNothingThatHadNoPrior) {
  ViewData& view = drawn_.views[0];
  for (size_t i = 0; i < view.depth.NumPixels(); ++i) {
    if (!IsMeasured(i)) {
      view.depth.Data()[i] = 0.f;
    }
  }
  const StereoMaps after = Match();
  for (size_t i = 0; i < view.depth.NumPixels(); ++i) {
    ASSERT_EQ(after.depth.Data()[i], view.depth.Data()[i]);
  }
}

TEST_F(MatchUnderPriorTest, NeedsSourcesThatConfirm) {
  for (size_t view = 1; view < drawn_.views.size(); ++view) {
    drawn_.views[view].depth = Image<float>(drawn_.views[view].depth.Width(),
                                            drawn_.views[view].depth.Height());
  }
  const StereoMaps after = Match();
  for (size_t i = 0; i < after.depth.NumPixels(); ++i) {
    if (!IsMeasured(i)) {
      ASSERT_EQ(after.depth.Data()[i], 0.f);
      ASSERT_EQ(after.normal.Data()[i].z, 0.f);
    }
  }
}

TEST_F(MatchUnderPriorTest, ThreadsDoNotMatter) {
  const StereoMaps one = Match(1);
  const StereoMaps three = Match(3);
  EXPECT_EQ(std::memcmp(one.depth.Data(),
                        three.depth.Data(),
                        one.depth.NumPixels() * sizeof(float)),
            0);
}

}  // namespace
}  // namespace tsar
