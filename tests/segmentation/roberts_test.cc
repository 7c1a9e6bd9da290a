// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/roberts.h"

#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

Rgb Gray(int level) {
  const uint8_t value = static_cast<uint8_t>(level);
  return {value, value, value};
}

Image<uint8_t> Detect(const Image<Rgb>& color) {
  const auto device = Device::CreateCpu(2);
  return DetectRobertsEdges(color.View(), 4.f, *device).ToHost();
}

// Two halves of these grey levels, side by side, that meet before column 5.
Image<uint8_t> DetectStep(int left, int right) {
  Image<Rgb> color(10, 6, Gray(left));
  for (int y = 0; y < 6; ++y) {
    for (int x = 5; x < 10; ++x) {
      color(x, y) = Gray(right);
    }
  }
  return Detect(color);
}

TEST(RobertsEdges, StepOfThreeGreyLevelsCountsOnBothDiagonals) {
  // sqrt(3^2 + 3^2) = 4.2 is above 4, sqrt(2^2 + 2^2) = 2.8 is not, at every
  // brightness.
  for (const int level : {0, 100, 200, 250}) {
    const Image<uint8_t> three = DetectStep(level, level + 3);
    const Image<uint8_t> two = DetectStep(level, level + 2);
    for (int y = 0; y < 5; ++y) {
      for (int x = 0; x < 10; ++x) {
        ASSERT_EQ(three(x, y), x == 4 ? 1 : 0) << level << ": " << x;
        ASSERT_EQ(two(x, y), 0);
      }
    }
  }
}

TEST(RobertsEdges, DoNotDependOnTheSign) {
  const Image<uint8_t> up = DetectStep(100, 105);
  const Image<uint8_t> down = DetectStep(105, 100);
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 10; ++x) {
      ASSERT_EQ(up(x, y), down(x, y));
    }
  }
  EXPECT_EQ(up(4, 2), 1);
}

TEST(RobertsEdges, IsolatedPixelCountsWhereADiagonalMeetsIt) {
  for (const auto& [step, expected] : {std::pair(3, 0), std::pair(5, 1)}) {
    Image<Rgb> color(7, 7, Gray(128));
    color(3, 3) = Gray(128 + step);
    const Image<uint8_t> edges = Detect(color);
    for (int y = 0; y < 7; ++y) {
      for (int x = 0; x < 7; ++x) {
        const bool touches = x >= 2 && x <= 3 && y >= 2 && y <= 3;
        ASSERT_EQ(edges(x, y), touches ? expected : 0) << x << ", " << y;
      }
    }
  }
}

TEST(RobertsEdges, DiagonalEdgeHasNoGaps) {
  Image<Rgb> color(12, 12, Gray(100));
  for (int y = 0; y < 12; ++y) {
    for (int x = y + 1; x < 12; ++x) {
      color(x, y) = Gray(105);
    }
  }
  const Image<uint8_t> edges = Detect(color);
  for (int i = 0; i < 11; ++i) {
    EXPECT_EQ(edges(i, i), 1) << i;
  }
  EXPECT_EQ(edges(0, 6), 0);
  EXPECT_EQ(edges(6, 0), 0);
}

TEST(RobertsEdges, PlainImageHasNone) {
  for (const uint8_t edge : Detect(Image<Rgb>(9, 5, {10, 200, 30}))) {
    ASSERT_EQ(edge, 0);
  }
  EXPECT_EQ(Detect(Image<Rgb>(1, 1, {10, 200, 30}))(0, 0), 0);
}

TEST(EdgesOfRoots, NeedLargerStepsTheBrighterItIs) {
  // 2 (sqrt(a) - sqrt(b))^2 > 4: from 1 to 6, from 100 to 131, from 120 to 153.
  const auto device = Device::CreateCpu(2);
  for (const auto& [level, step] :
       {std::pair(1, 5), std::pair(100, 31), std::pair(120, 33)}) {
    for (const int more : {0, -1}) {
      Image<Rgb> color(4, 3, Gray(level));
      for (int y = 0; y < 3; ++y) {
        color(2, y) = color(3, y) = Gray(level + step + more);
      }
      const Image<uint8_t> edges =
          DetectEdgesOfRoots(color.View(), 4.f, *device).ToHost();
      EXPECT_EQ(edges(1, 0), more == 0 ? 1 : 0) << level;
      EXPECT_EQ(edges(0, 0), 0) << level;
    }
  }
}

}  // namespace
}  // namespace tsar
