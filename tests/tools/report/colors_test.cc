// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/colors.h"

#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace tsar {
namespace {

using Numbers = std::tuple<int, int, int>;
constexpr Numbers kBlack = {0, 0, 0};

Numbers NumbersOf(const Rgb& color) { return {color.r, color.g, color.b}; }

int Brightness(const Rgb& color) { return color.r + color.g + color.b; }

TEST(RobustDepthRange, IgnoresHolesAndWildDepthsOfBothMaps) {
  Image<float> before(20, 10, 0.f);
  Image<float> after(20, 10, 3.f);
  before(0, 0) = 1e6f;
  before(1, 0) = 1e-6f;
  for (int x = 0; x < 20; ++x) {
    before(x, 1) = 2.f;
    after(x, 2) = 5.f;
  }
  const DepthRange range = RobustDepthRange(before, after);
  EXPECT_FLOAT_EQ(range.nearest, 2.f);
  EXPECT_FLOAT_EQ(range.farthest, 5.f);
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
  const auto color_of = [](float depth) {
    return ColorizeDepth(Image<float>(1, 1, depth), {2.f, 4.f})(0, 0);
  };
  const Rgb near = color_of(2.f);
  const Rgb far = color_of(4.f);
  EXPECT_GT(near.r, near.b);
  EXPECT_GT(far.b, far.r);
  EXPECT_EQ(NumbersOf(color_of(0.f)), kBlack);
  // What is out of the range has the color of its end.
  EXPECT_EQ(NumbersOf(color_of(1e-30f)), NumbersOf(near));
  EXPECT_EQ(NumbersOf(color_of(1e30f)), NumbersOf(far));
}

TEST(ColorizeNormals, TellsDirectionsAsTheViewerSeesThem) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::pair<Vec3f, Numbers> cases[] = {
      {{1.f, 0.f, 0.f}, {255, 128, 128}},   // Right.
      {{0.f, -1.f, 0.f}, {128, 255, 128}},  // Up.
      {{0.f, 0.f, -1.f}, {128, 128, 255}},  // To the camera.
      {{-0.6f, 0.f, -0.8f}, {51, 128, 230}},
      {{9.f, 9.f, -9.f}, {255, 0, 255}},
      {{}, kBlack},
      {{nan, 0.f, 1.f}, kBlack},
  };
  for (const auto& [normal, expected] : cases) {
    EXPECT_EQ(NumbersOf(ColorizeNormals(Image<Vec3f>(1, 1, normal))(0, 0)),
              expected);
  }
}

TEST(ColorizeConfidence, GrowsBrighterFromOneOn) {
  Image<uint8_t> levels(5, 1);
  const uint8_t in_order[] = {0, 1, 80, 160, 255};
  std::copy(std::begin(in_order), std::end(in_order), levels.begin());
  const Image<Rgb> colors = ColorizeConfidence(levels);
  EXPECT_EQ(NumbersOf(colors(0, 0)), kBlack);
  for (int x = 1; x < levels.Width(); ++x) {
    EXPECT_LT(Brightness(colors(x - 1, 0)), Brightness(colors(x, 0)));
  }
}

TEST(ColorizePlanes, TellsTheFirstPlanesApart) {
  Image<uint16_t> planes(50, 1);
  for (int x = 0; x < 50; ++x) {
    planes(x, 0) = static_cast<uint16_t>(x);
  }
  const Image<Rgb> colors = ColorizePlanes(planes);
  EXPECT_EQ(NumbersOf(colors(0, 0)), kBlack);
  std::set<Numbers> different;
  for (const Rgb& color : colors) {
    different.insert(NumbersOf(color));
  }
  EXPECT_EQ(different.size(), 50u);
}

}  // namespace
}  // namespace tsar
