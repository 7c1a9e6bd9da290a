// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/common_heights.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// At every tenth from begin to end, in this direction.
std::vector<double> Heights(double begin, double end) {
  std::vector<double> heights;
  const int count = static_cast<int>(std::lround(10.0 * std::abs(end - begin)));
  for (int i = 0; i <= count; ++i) {
    heights.push_back(begin + (end - begin) * i / count);
  }
  return heights;
}

TEST(CommonHeightsTest, FindsWhatEnoughViewsSee) {
  const std::vector<std::vector<double>> heights = {
      Heights(0.0, 4.0), Heights(5.0, 2.0), Heights(3.0, 9.0)};
  std::vector<HeightRange> ranges = FindCommonHeights(heights, 0.1, 2);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_NEAR(ranges[0].min, 2.0, 0.11);
  EXPECT_NEAR(ranges[0].max, 5.0, 0.11);
  ranges = FindCommonHeights(heights, 0.1, 3);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_NEAR(ranges[0].min, 3.0, 0.11);
  EXPECT_NEAR(ranges[0].max, 4.0, 0.11);
  EXPECT_TRUE(FindCommonHeights(heights, 0.1, 4).empty());
}

TEST(CommonHeightsTest, ClosesSmallGapsAlone) {
  std::vector<double> heights = Heights(0.0, 2.0);
  const std::vector<double> above = Heights(2.7, 4.0);
  heights.insert(heights.end(), above.begin(), above.end());
  std::vector<HeightRange> ranges = FindCommonHeights({heights}, 0.1, 1);
  ASSERT_EQ(ranges.size(), 1u);
  EXPECT_NEAR(ranges[0].Length(), 4.0, 0.2);
  // The same gap in bins half as long.
  ranges = FindCommonHeights({heights}, 0.05, 1);
  ASSERT_EQ(ranges.size(), 2u);
  EXPECT_NEAR(ranges[0].min, 0.0, 0.1);
  EXPECT_NEAR(ranges[0].max, 2.0, 0.1);
  EXPECT_NEAR(ranges[1].min, 2.7, 0.1);
  EXPECT_NEAR(ranges[1].max, 4.0, 0.1);
}

TEST(CommonHeightsTest, FindsNothingInNothing) {
  EXPECT_TRUE(FindCommonHeights({}, 0.1, 1).empty());
  EXPECT_TRUE(FindCommonHeights({{}, {}}, 0.1, 1).empty());
  EXPECT_TRUE(FindCommonHeights({{0.0, 1e9}}, 0.1, 1).empty());
}

TEST(CommonHeightsTest, RangesThatMeetDoNotOverlap) {
  const HeightRange range = {1.0, 2.0};
  EXPECT_TRUE(range.Overlaps(range));
  EXPECT_TRUE(range.Overlaps({1.7, 9.0}));
  EXPECT_TRUE(range.Overlaps({1.4, 1.5}));
  EXPECT_FALSE(range.Overlaps({1.9, 9.0}));
  EXPECT_FALSE(range.Overlaps({2.0, 3.0}));
  EXPECT_FALSE(range.Overlaps({5.0, 6.0}));
  EXPECT_FALSE(range.Overlaps({1.5, 1.5}));
}

}  // namespace
}  // namespace tsar
