// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/depth_colors.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

int Brightness(const Rgb& color) { return color.r + color.g + color.b; }

TEST(RobustDepthRange, IgnoresHolesAndWildDepths) {
  Image<float> before(20, 10, 0.f);
  Image<float> after(20, 10, 3.f);
  before(0, 0) = 1e6f;
  before(1, 0) = 1e-6f;
  after(0, 0) = 2.f;
  for (int x = 0; x < 20; ++x) {
    after(x, 1) = 2.f;
    after(x, 2) = 5.f;
  }
  const DepthRange range = RobustDepthRange(before, after);
  EXPECT_FLOAT_EQ(range.nearest, 2.f);
  EXPECT_FLOAT_EQ(range.farthest, 5.f);
}

TEST(RobustDepthRange, LooksAtBothMaps) {
  const DepthRange range =
      RobustDepthRange(Image<float>(8, 8, 1.f), Image<float>(8, 8, 4.f));
  EXPECT_FLOAT_EQ(range.nearest, 1.f);
  EXPECT_FLOAT_EQ(range.farthest, 4.f);
}

TEST(RobustDepthRange, IsNeverEmpty) {
  for (const float depth : {0.f, 7.f}) {
    const Image<float> map(4, 4, depth);
    const DepthRange range = RobustDepthRange(map, map);
    EXPECT_GT(range.nearest, 0.f);
    EXPECT_GT(range.farthest, range.nearest);
  }
}

TEST(ColorizeDepth, NearIsRedFarIsBlueNoneIsBlack) {
  Image<float> depth(3, 1);
  depth(0, 0) = 2.f;
  depth(1, 0) = 4.f;
  const Image<Rgb> colors = ColorizeDepth(depth, {2.f, 4.f});
  EXPECT_GT(colors(0, 0).r, colors(0, 0).b);
  EXPECT_GT(colors(1, 0).b, colors(1, 0).r);
  EXPECT_EQ(Brightness(colors(2, 0)), 0);
  EXPECT_GT(Brightness(colors(0, 0)), 0);
  EXPECT_GT(Brightness(colors(1, 0)), 0);
}

TEST(ColorizeDepth, DepthsOutsideTheRangeHaveTheColorOfItsEnd) {
  Image<float> depth(4, 1);
  depth(0, 0) = 2.f;
  depth(1, 0) = 1e-30f;
  depth(2, 0) = 4.f;
  depth(3, 0) = 1e30f;
  const Image<Rgb> colors = ColorizeDepth(depth, {2.f, 4.f});
  for (const int x : {0, 2}) {
    EXPECT_EQ(colors(x, 0).r, colors(x + 1, 0).r);
    EXPECT_EQ(colors(x, 0).g, colors(x + 1, 0).g);
    EXPECT_EQ(colors(x, 0).b, colors(x + 1, 0).b);
  }
}

}  // namespace
}  // namespace tsar
