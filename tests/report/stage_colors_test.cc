// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/label_colors.h"
#include "colmap_tsar/report/value_colors.h"

#include <limits>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

namespace tsar {
namespace {

int Brightness(const Rgb& color) { return color.r + color.g + color.b; }

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

TEST(DrawLabelBorders, DrawsOnlyBetweenLabels) {
  Image<int> labels(4, 2, 3);
  labels(2, 0) = labels(3, 0) = 5;
  labels(2, 1) = labels(3, 1) = 5;
  const Rgb gray = {100, 100, 100};
  const Image<Rgb> drawn = DrawLabelBorders(labels, Image<Rgb>(4, 2, gray));
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      EXPECT_EQ(drawn(x, y).r == 100, x != 2) << x << " " << y;
    }
  }
}

}  // namespace
}  // namespace tsar
