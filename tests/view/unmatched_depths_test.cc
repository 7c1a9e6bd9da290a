// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/unmatched_depths.h"

#include "colmap_tsar/matching/matching_cost.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr float kDepth = 2.f;
// Of a camera beside another, in the image.
constexpr int kDisparity = 10;
// Left of this column of the wall it is bare, right of it textured.
constexpr int kEdge = 48;

uint8_t WallLevel(int column, int row) {
  if (column < kEdge) {
    return 120;
  }
  const auto x = static_cast<double>(column);
  const auto y = static_cast<double>(row);
  return static_cast<uint8_t>(128.0 + 40.0 * std::sin(0.9 * x + 0.2 * y) +
                              30.0 * std::sin(0.61 * y - 0.35 * x + 1.0) +
                              20.0 * std::sin(0.43 * x + 0.47 * y + 2.0));
}

// Number `place` of cameras side by side before a wall.
ViewData DrawView(int place) {
  ViewData view;
  view.camera = SyntheticCamera(kWidth, kHeight, 100.0);
  view.camera.translation.x() = -place * kDisparity * kDepth / 100.0;
  view.color = Image<Rgb>(kWidth, kHeight);
  view.depth = Image<float>(kWidth, kHeight, kDepth);
  view.normal = Image<Vec3f>(kWidth, kHeight, Vec3f{0.f, 0.f, -1.f});
  view.is_to_refine = Image<uint8_t>(kWidth, kHeight, 1);
  view.min_cost = Image<float>(kWidth, kHeight, 0.1f);
  view.second_cost = Image<float>(kWidth, kHeight, 0.2f);
  view.num_depths_to_refine = kWidth * kHeight;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const uint8_t level = WallLevel(x + place * kDisparity, y);
      view.color(x, y) = {level, level, level};
    }
  }
  return view;
}

void DropUnmatched(const std::vector<ViewData>& sources, ViewData* view) {
  UnmatchedDepths unmatched(*view, static_cast<int>(sources.size()));
  for (const ViewData& source : sources) {
    unmatched.CompareWith(source);
  }
  unmatched.Drop(view);
}

int64_t CountDepths(const ViewData& view, int begin_x, int end_x) {
  int64_t count = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = begin_x; x < end_x; ++x) {
      count += view.depth(x, y) > 0.f ? 1 : 0;
    }
  }
  return count;
}

class UnmatchedDepthsTest : public testing::Test {
 protected:
  // To the right of it the textured part is seen by both sources.
  static constexpr int kTextured = kEdge + 6;
  static constexpr int kSeenEnd = kWidth - 12;

  ViewData view_ = DrawView(0);
  std::vector<ViewData> sources_ = {DrawView(-1), DrawView(1)};
};

TEST_F(UnmatchedDepthsTest, DropsThoseOfTheBareWall) {
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(CountDepths(view_, 0, kEdge - 5), 0);
  EXPECT_EQ(CountDepths(view_, kTextured, kSeenEnd),
            (kSeenEnd - kTextured) * kHeight);
  EXPECT_EQ(view_.num_depths_to_refine, CountDepths(view_, 0, kWidth));
  EXPECT_EQ(view_.normal(10, 10), Vec3f{});
  EXPECT_EQ(view_.is_to_refine(10, 10), 0);
  EXPECT_EQ(view_.min_cost(10, 10), kUndefinedCost);
  EXPECT_EQ(view_.second_cost(10, 10), kUndefinedCost);
  EXPECT_EQ(view_.depth(70, 10), kDepth);
  EXPECT_EQ(view_.is_to_refine(70, 10), 1);
  EXPECT_EQ(view_.min_cost(70, 10), 0.1f);
}

TEST_F(UnmatchedDepthsTest, DropsAPlaneThatAllViewsHaveWrong) {
  for (ViewData* view : {&view_, &sources_[0], &sources_[1]}) {
    std::fill(view->depth.begin(), view->depth.end(), 1.5f * kDepth);
  }
  DropUnmatched(sources_, &view_);
  EXPECT_LT(view_.num_depths_to_refine, kWidth * kHeight / 50);
}

TEST_F(UnmatchedDepthsTest, OneSourceIsEnoughWhereThereIsNoOther) {
  sources_.pop_back();
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(CountDepths(view_, 0, kEdge - 5), 0);
  EXPECT_EQ(CountDepths(view_, kTextured, kSeenEnd),
            (kSeenEnd - kTextured) * kHeight);
}

TEST_F(UnmatchedDepthsTest, OneOfTwoIsNotEnough) {
  std::fill(sources_[1].depth.begin(), sources_[1].depth.end(), 0.f);
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(view_.num_depths_to_refine, 0);
}

TEST_F(UnmatchedDepthsTest, LeavesHypothesesOfTheOtherType) {
  view_.is_to_refine(10, 10) = 0;
  --view_.num_depths_to_refine;
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(view_.depth(10, 10), kDepth);
  EXPECT_EQ(view_.num_depths_to_refine, CountDepths(view_, 0, kWidth) - 1);
}

TEST_F(UnmatchedDepthsTest, CostsAreOptional) {
  view_.min_cost = {};
  view_.second_cost = {};
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(CountDepths(view_, 0, kEdge - 5), 0);
  EXPECT_TRUE(view_.min_cost.Empty());
}

TEST_F(UnmatchedDepthsTest, MapsOfSourcesMayHaveAnotherSize) {
  for (ViewData& source : sources_) {
    ViewData half;
    half.camera = source.camera.Resized(kWidth / 2, kHeight / 2);
    half.depth = Image<float>(kWidth / 2, kHeight / 2, kDepth);
    half.color = Image<Rgb>(kWidth / 2, kHeight / 2);
    for (int y = 0; y < kHeight / 2; ++y) {
      for (int x = 0; x < kWidth / 2; ++x) {
        half.color(x, y) = source.color(2 * x, 2 * y);
      }
    }
    source = std::move(half);
  }
  DropUnmatched(sources_, &view_);
  EXPECT_EQ(CountDepths(view_, 0, kEdge - 8), 0);
  EXPECT_GT(CountDepths(view_, kTextured, kSeenEnd),
            (kSeenEnd - kTextured) * kHeight / 2);
}

TEST(IsUnfiltered, TellsMapsWithHoles) {
  EXPECT_TRUE(IsUnfiltered(1000, 1000));
  // As programs leave out the margin of the map.
  EXPECT_TRUE(IsUnfiltered(980, 1000));
  EXPECT_FALSE(IsUnfiltered(979, 1000));
  EXPECT_FALSE(IsUnfiltered(0, 1000));
  EXPECT_FALSE(IsUnfiltered(0, 0));
}

}  // namespace
}  // namespace tsar
