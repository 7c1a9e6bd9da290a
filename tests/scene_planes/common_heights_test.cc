// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/common_heights.h"

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
  HeightRange range = LongestCommonHeights(heights, 0.1, 2);
  EXPECT_NEAR(range.min, 2.0, 0.11);
  EXPECT_NEAR(range.max, 5.0, 0.11);
  range = LongestCommonHeights(heights, 0.1, 3);
  EXPECT_NEAR(range.min, 3.0, 0.11);
  EXPECT_NEAR(range.max, 4.0, 0.11);
  range = LongestCommonHeights(heights, 0.1, 4);
  EXPECT_EQ(range.max - range.min, 0.0);
}

TEST(CommonHeightsTest, ClosesSmallGapsAlone) {
  std::vector<double> heights = Heights(0.0, 2.0);
  const std::vector<double> above = Heights(2.7, 4.0);
  heights.insert(heights.end(), above.begin(), above.end());
  HeightRange range = LongestCommonHeights({heights}, 0.1, 1);
  EXPECT_NEAR(range.max - range.min, 4.0, 0.2);
  // The same gap in bins half as long.
  range = LongestCommonHeights({heights}, 0.05, 1);
  EXPECT_NEAR(range.min, 0.0, 0.1);
  EXPECT_NEAR(range.max, 2.0, 0.1);
}

TEST(CommonHeightsTest, FindsNothingInNothing) {
  for (const HeightRange& range :
       {LongestCommonHeights({}, 0.1, 1),
        LongestCommonHeights({{}, {}}, 0.1, 1),
        LongestCommonHeights({{0.0, 1e9}}, 0.1, 1)}) {
    EXPECT_EQ(range.min, 0.0);
    EXPECT_EQ(range.max, 0.0);
  }
}

}  // namespace
}  // namespace tsar
