// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/colors.h"

#include <limits>
#include <set>
#include <tuple>

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

Rgb ColorOf(const Vec3f& normal) {
  return ColorizeNormals(Image<Vec3f>(1, 1, normal))(0, 0);
}

void ExpectColor(const Vec3f& normal, const Rgb& expected) {
  const Rgb color = ColorOf(normal);
  EXPECT_EQ(color.r, expected.r);
  EXPECT_EQ(color.g, expected.g);
  EXPECT_EQ(color.b, expected.b);
}

TEST(ColorizeNormals, TellsDirectionsAsTheViewerSeesThem) {
  ExpectColor({1.f, 0.f, 0.f}, {255, 128, 128});   // Right.
  ExpectColor({0.f, -1.f, 0.f}, {128, 255, 128});  // Up.
  ExpectColor({0.f, 0.f, -1.f}, {128, 128, 255});  // To the camera.
  ExpectColor({-0.6f, 0.f, -0.8f}, {51, 128, 230});
}

TEST(ColorizeNormals, NoNormalIsBlack) {
  ExpectColor({}, {0, 0, 0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ExpectColor({nan, 0.f, 1.f}, {0, 0, 0});
}

TEST(ColorizeNormals, BoundsWhatIsTooLong) {
  ExpectColor({9.f, 9.f, -9.f}, {255, 0, 255});
}

TEST(ColorizeNormals, KeepsTheSize) {
  const Image<Rgb> colors = ColorizeNormals(Image<Vec3f>(3, 2));
  EXPECT_EQ(colors.Width(), 3);
  EXPECT_EQ(colors.Height(), 2);
  EXPECT_TRUE(ColorizeNormals({}).Empty());
}

bool IsBlack(const Rgb& color) { return Brightness(color) == 0; }

TEST(ColorizeValues, GrowsBrighterAndStopsAtTheEnds) {
  Image<float> values(6, 1);
  const float in_order[] = {-1.f, 0.f, 0.5f, 1.f, 2.f, 9.f};
  std::copy(std::begin(in_order), std::end(in_order), values.begin());
  const Image<Rgb> colors = ColorizeValues(values, 2.f);
  EXPECT_EQ(Brightness(colors(0, 0)), Brightness(colors(1, 0)));
  for (int x = 1; x + 2 < values.Width(); ++x) {
    EXPECT_LT(Brightness(colors(x, 0)), Brightness(colors(x + 1, 0)));
  }
  EXPECT_EQ(Brightness(colors(4, 0)), Brightness(colors(5, 0)));
  EXPECT_FALSE(IsBlack(colors(0, 0)));
}

TEST(ColorizeValues, IsBlackOutsideOfTheMask) {
  Image<float> mask(2, 1, 1.f);
  mask(1, 0) = 0.f;
  const Image<Rgb> colors = ColorizeValues(Image<float>(2, 1, 1.f), 1.f, &mask);
  EXPECT_FALSE(IsBlack(colors(0, 0)));
  EXPECT_TRUE(IsBlack(colors(1, 0)));
}

TEST(ColorizeValues, TakesWhatIsNotANumberForNothing) {
  const Image<Rgb> colors = ColorizeValues(
      Image<float>(1, 1, std::numeric_limits<float>::quiet_NaN()), 1.f);
  const Image<Rgb> zero = ColorizeValues(Image<float>(1, 1), 1.f);
  EXPECT_EQ(colors(0, 0).r, zero(0, 0).r);
  EXPECT_EQ(colors(0, 0).b, zero(0, 0).b);
}

TEST(ColorizeLabels, TellsTheFirstLabelsApart) {
  Image<int> labels(50, 1);
  for (int x = 0; x < 50; ++x) {
    labels(x, 0) = x - 1;
  }
  const Image<Rgb> colors = ColorizeLabels(labels);
  EXPECT_TRUE(IsBlack(colors(0, 0)));
  std::set<std::tuple<int, int, int>> different;
  for (const Rgb& color : colors) {
    different.emplace(color.r, color.g, color.b);
  }
  EXPECT_EQ(different.size(), 50u);
}

}  // namespace
}  // namespace tsar
