// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/edges.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <utility>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

Rgb Gray(int level) {
  const uint8_t value = static_cast<uint8_t>(level);
  return {value, value, value};
}

Image<uint8_t> Detect(const Image<Rgb>& color) {
  const auto device = CreateTestDevice(2);
  return DetectRobertsEdges(DeviceCopies(*device)(color), 4.f, *device)
      .ToHost();
}

// Two halves of these gray levels, side by side, that meet before column 5.
Image<uint8_t> DetectStep(int left, int right) {
  Image<Rgb> color(10, 6, Gray(left));
  ForEachPixel(5, 10, 0, 6, [&](int x, int y) { color(x, y) = Gray(right); });
  return Detect(color);
}

TEST(RobertsEdges, StepOfThreeGrayLevelsCountsOnBothDiagonals) {
  // sqrt(3^2 + 3^2) = 4.2 is above 4, sqrt(2^2 + 2^2) = 2.8 is not, at every
  // brightness.
  for (const int level : {0, 100, 200, 250}) {
    const Image<uint8_t> three = DetectStep(level, level + 3);
    const Image<uint8_t> two = DetectStep(level, level + 2);
    ForEachPixel(10, 5, [&](int x, int y) {
      ASSERT_EQ(three(x, y), x == 4 ? 1 : 0) << level << ": " << x;
      ASSERT_EQ(two(x, y), 0);
    });
  }
}

TEST(RobertsEdges, IsolatedPixelCountsWhereADiagonalMeetsIt) {
  for (const auto& [step, expected] : {std::pair(3, 0), std::pair(5, 1)}) {
    Image<Rgb> color(7, 7, Gray(128));
    color(3, 3) = Gray(128 + step);
    const Image<uint8_t> edges = Detect(color);
    ForEachPixel(7, 7, [&](int x, int y) {
      const bool touches = x >= 2 && x <= 3 && y >= 2 && y <= 3;
      ASSERT_EQ(edges(x, y), touches ? expected : 0) << x << ", " << y;
    });
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

// The edges and the segments through them.
Image<uint8_t> Draw(const Image<uint8_t>& edges, int max_gap = 15) {
  const auto device = CreateTestDevice(2);
  return DrawLineSegments(DeviceCopies(*device)(edges), max_gap, *device)
      .ToHost();
}

int CountDrawn(const Image<uint8_t>& edges, int max_gap = 15) {
  const Image<uint8_t> drawn = Draw(edges, max_gap);
  int count = 0;
  for (size_t i = 0; i < edges.NumPixels(); ++i) {
    EXPECT_TRUE(drawn.Data()[i] != 0 || edges.Data()[i] == 0);
    count += drawn.Data()[i] != 0 && edges.Data()[i] == 0 ? 1 : 0;
  }
  return count;
}

// A horizontal line in row 40 with a gap of this many pixels after column 79,
// or the same line downwards.
Image<uint8_t> DrawLineWithGap(int gap, bool vertical) {
  Image<uint8_t> edges(200, 200, 0);
  for (int i = 20; i < 140 + gap; ++i) {
    if (i < 80 || i >= 80 + gap) {
      (vertical ? edges(40, i) : edges(i, 40)) = 1;
    }
  }
  return edges;
}

TEST(LineSegments, CrossGapsUpToATenthOfTheirLength) {
  for (const bool vertical : {false, true}) {
    for (const auto& [gap, crossed] :
         {std::pair(3, true), std::pair(5, true), std::pair(14, false)}) {
      SCOPED_TRACE(gap);
      const Image<uint8_t> drawn = Draw(DrawLineWithGap(gap, vertical));
      for (int i = 20; i < 140 + gap; ++i) {
        const bool in_gap = i >= 80 && i < 80 + gap;
        ASSERT_EQ(vertical ? drawn(40, i) : drawn(i, 40),
                  !in_gap || crossed ? 1 : 0)
            << i;
      }
    }
  }
}

TEST(LineSegments, CrossNoGapLongerThanTheLongest) {
  EXPECT_EQ(Draw(DrawLineWithGap(4, false), 4)(81, 40), 1);
  EXPECT_EQ(Draw(DrawLineWithGap(5, false), 4)(81, 40), 0);
}

// A horizontal row of this many pixels with a gap of one in its middle.
Image<uint8_t> DrawShortLine(int length) {
  Image<uint8_t> edges(400, 300, 0);
  for (int i = 0; i < length; ++i) {
    edges(100 + i, 50) = i == length / 2 ? 0 : 1;
  }
  return edges;
}

TEST(LineSegments, ShorterThanTheirLeastLengthAreDropped) {
  // The shorter side of 300 pixels requires a length of 10.
  EXPECT_EQ(CountDrawn(DrawShortLine(10)), 0);
  EXPECT_EQ(CountDrawn(DrawShortLine(14)), 1);
}

TEST(LineSegments, FollowSlantedLines) {
  for (const double angle : {0.2, 0.7854, 1.3, 2.0, 2.8}) {
    Image<uint8_t> whole(160, 160, 0);
    Image<uint8_t> edges(160, 160, 0);
    for (double t = -60.0; t <= 60.0; t += 0.25) {
      const int x = static_cast<int>(std::lround(80.0 + t * std::cos(angle)));
      const int y = static_cast<int>(std::lround(80.0 + t * std::sin(angle)));
      whole(x, y) = 1;
      // Gaps of two or three pixels on both sides of the middle.
      const int distance = std::abs(x - 80) + std::abs(y - 80);
      edges(x, y) = distance >= 20 && distance <= 22 ? 0 : 1;
    }
    const Image<uint8_t> drawn = Draw(edges);
    int num_missing = 0;
    int num_closed = 0;
    int num_wrong = 0;
    ForEachPixel(160, 160, [&](int x, int y) {
      const double distance =
          std::abs((y - 80.0) * std::cos(angle) - (x - 80.0) * std::sin(angle));
      const bool missing = whole(x, y) && !edges(x, y);
      num_missing += missing ? 1 : 0;
      num_closed += missing && drawn(x, y) ? 1 : 0;
      num_wrong += drawn(x, y) && distance > 2.0 ? 1 : 0;
    });
    EXPECT_GE(num_missing, 2) << angle;
    EXPECT_GT(num_closed, 0.5 * num_missing) << angle;
    EXPECT_EQ(num_wrong, 0) << angle;
  }
}

TEST(LineSegments, HaveNoGapsInAnyDirection) {
  // Lines of which every other pixel is missing.
  for (const auto& [dx, dy] :
       {std::pair(2, 0), std::pair(0, 2), std::pair(2, 2), std::pair(-2, 2)}) {
    Image<uint8_t> edges(101, 101, 0);
    for (int i = -20; i <= 20; ++i) {
      edges(50 + i * dx, 50 + i * dy) = 1;
    }
    const Image<uint8_t> drawn = Draw(edges);
    for (int i = -40; i <= 40; ++i) {
      EXPECT_EQ(drawn(50 + i * dx / 2, 50 + i * dy / 2), 1)
          << dx << ", " << dy << ": " << i;
    }
  }
}

TEST(LineSegments, CopeWithAnImageOfEdgesOnly) {
  for (const auto& [width, height] : {std::pair(90, 70),
                                      std::pair(1, 1),
                                      std::pair(1, 60),
                                      std::pair(60, 1),
                                      std::pair(3001, 3)}) {
    EXPECT_EQ(CountDrawn(Image<uint8_t>(width, height, 1)), 0);
  }
}

}  // namespace
}  // namespace tsar
