// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/untextured_depths.h"

#include "colmap_tsar/matching/matching_cost.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;
// Left of it the wall is bare, right of it textured.
constexpr int kEdge = 48;

// A wall whose levels are uniformly `noise` about their means.
ViewData DrawView(int noise) {
  ViewData view;
  view.color = Image<Rgb>(kWidth, kHeight);
  view.depth = Image<float>(kWidth, kHeight, 2.f);
  view.normal = Image<Vec3f>(kWidth, kHeight, Vec3f{0.f, 0.f, -1.f});
  view.is_to_refine = Image<uint8_t>(kWidth, kHeight, 1);
  view.min_cost = Image<float>(kWidth, kHeight, 0.1f);
  view.second_cost = Image<float>(kWidth, kHeight, 0.2f);
  view.num_depths_to_refine = kWidth * kHeight;
  uint32_t state = 1;
  const auto draw = [&] {
    state = state * 1664525u + 1013904223u;
    return static_cast<int>((state >> 16) % (2u * noise + 1u)) - noise;
  };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const int mean = x < kEdge ? 120 : (x / 2 + y / 2) % 2 == 0 ? 80 : 160;
      const auto level = static_cast<uint8_t>(mean + draw());
      view.color(x, y) = {level, level, level};
    }
  }
  return view;
}

void RemoveDepth(int x, int y, ViewData* view) {
  view->depth(x, y) = 0.f;
  view->normal(x, y) = {};
  view->is_to_refine(x, y) = 0;
  --view->num_depths_to_refine;
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

TEST(DropUntexturedDepths, DropsThoseOfTheBareWallAlone) {
  ViewData view = DrawView(0);
  DropUntexturedDepths(&view);
  // Windows along the edge hold some of the texture.
  constexpr int kBareEnd = kEdge - 2;
  EXPECT_EQ(CountDepths(view, 0, kBareEnd), 0);
  EXPECT_EQ(CountDepths(view, kBareEnd, kWidth), (kWidth - kBareEnd) * kHeight);
  EXPECT_EQ(view.num_depths_to_refine, (kWidth - kBareEnd) * kHeight);
  EXPECT_EQ(view.normal(10, 10), Vec3f{});
  EXPECT_EQ(view.is_to_refine(10, 10), 0);
  EXPECT_EQ(view.min_cost(10, 10), kUndefinedCost);
  EXPECT_EQ(view.second_cost(10, 10), kUndefinedCost);
  EXPECT_EQ(view.depth(70, 10), 2.f);
  EXPECT_EQ(view.is_to_refine(70, 10), 1);
  EXPECT_EQ(view.min_cost(70, 10), 0.1f);
}

// The variance of the noise is 24, far above that of an image without noise.
TEST(DropUntexturedDepths, NoiseIsNoTexture) {
  ViewData view = DrawView(8);
  DropUntexturedDepths(&view);
  constexpr int64_t kNumBare = (kEdge - 2) * kHeight;
  EXPECT_LT(CountDepths(view, 0, kEdge - 2), kNumBare / 50);
  EXPECT_EQ(CountDepths(view, kEdge, kWidth), (kWidth - kEdge) * kHeight);
}

// Nothing in the image tells its texture from noise but how strong it is.
TEST(DropUntexturedDepths, TextureAllOverIsNoNoise) {
  ViewData view = DrawView(60);
  DropUntexturedDepths(&view);
  EXPECT_EQ(CountDepths(view, 0, kWidth), kWidth * kHeight);
}

TEST(DropUntexturedDepths, LeavesMapsWithHolesAsTheyAre) {
  ViewData view = DrawView(0);
  // 6 % of the pixels.
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      RemoveDepth(x, y, &view);
    }
  }
  DropUntexturedDepths(&view);
  EXPECT_EQ(CountDepths(view, 0, kWidth), kWidth * (kHeight - 4));
  EXPECT_EQ(view.num_depths_to_refine, kWidth * (kHeight - 4));
}

// As programs leave out the margin of the map.
TEST(DropUntexturedDepths, AFewPixelsAreNoHoles) {
  ViewData view = DrawView(0);
  for (int x = 0; x < kWidth; ++x) {
    RemoveDepth(x, 0, &view);
  }
  // Of the other type.
  view.depth(5, 0) = 3.f;
  DropUntexturedDepths(&view);
  EXPECT_EQ(CountDepths(view, 0, kEdge - 2), 1);
  EXPECT_EQ(view.depth(5, 0), 3.f);
  EXPECT_EQ(view.num_depths_to_refine, CountDepths(view, kEdge - 2, kWidth));
}

TEST(DropUntexturedDepths, CostsAreOptional) {
  ViewData view = DrawView(0);
  view.min_cost = {};
  view.second_cost = {};
  DropUntexturedDepths(&view);
  EXPECT_EQ(CountDepths(view, 0, kEdge - 2), 0);
  EXPECT_TRUE(view.min_cost.Empty());
}

TEST(DropUntexturedDepths, ABareViewLosesAllAndAnEmptyOneNothing) {
  ViewData view = DrawView(0);
  for (Rgb& color : view.color) {
    color = {200, 200, 200};
  }
  DropUntexturedDepths(&view);
  EXPECT_EQ(view.num_depths_to_refine, 0);
  EXPECT_EQ(CountDepths(view, 0, kWidth), 0);
  DropUntexturedDepths(&view);
  EXPECT_EQ(view.num_depths_to_refine, 0);
}

// Smaller than the blocks in which noise is estimated.
TEST(DropUntexturedDepths, WorksOnTheSmallestMaps) {
  ViewData view;
  view.color = Image<Rgb>(3, 2, Rgb{10, 10, 10});
  view.depth = Image<float>(3, 2, 1.f);
  view.normal = Image<Vec3f>(3, 2, Vec3f{0.f, 0.f, -1.f});
  view.is_to_refine = Image<uint8_t>(3, 2, 1);
  view.num_depths_to_refine = 6;
  DropUntexturedDepths(&view);
  EXPECT_EQ(view.num_depths_to_refine, 0);
}

}  // namespace
}  // namespace tsar
