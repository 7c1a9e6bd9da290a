// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/hough.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

std::vector<LineSegment> Detect(const Image<uint8_t>& edges,
                                const HoughOptions& options = {}) {
  return DetectLineSegments(edges.View(), options);
}

// The pixels that the detected segments cover.
Image<uint8_t> Cover(const Image<uint8_t>& edges,
                     const HoughOptions& options = {}) {
  Image<uint8_t> covered(edges.Width(), edges.Height(), 0);
  DrawLineSegments(Detect(edges, options), covered.View());
  return covered;
}

// A horizontal line in row 40 with a gap of so many pixels after column 79, or
// the same line downwards.
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
      const Image<uint8_t> covered = Cover(DrawLineWithGap(gap, vertical));
      for (int i = 20; i < 140 + gap; ++i) {
        const bool in_gap = i >= 80 && i < 80 + gap;
        ASSERT_EQ(vertical ? covered(40, i) : covered(i, 40),
                  !in_gap || crossed ? 1 : 0)
            << i;
      }
    }
  }
}

TEST(LineSegments, CrossNoGapLongerThanTheLongest) {
  HoughOptions options;
  options.max_gap = 4;
  EXPECT_EQ(Cover(DrawLineWithGap(4, false), options)(81, 40), 1);
  EXPECT_EQ(Cover(DrawLineWithGap(5, false), options)(81, 40), 0);
}

TEST(LineSegments, ShorterThanTheirLeastLengthAreDropped) {
  // The shorter side of 300 pixels asks for a length of 10.
  Image<uint8_t> edges(400, 300, 0);
  for (int i = 0; i < 8; ++i) {
    edges(100 + i, 50) = 1;
    edges(200, 150 + i) = 1;
  }
  EXPECT_TRUE(Detect(edges).empty());
  for (int i = 0; i < 12; ++i) {
    edges(100 + i, 250) = 1;
  }
  const std::vector<LineSegment> segments = Detect(edges);
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(segments[0].y0, 250);
  EXPECT_EQ(segments[0].y1, 250);
}

TEST(LineSegments, NeedTheirVotes) {
  Image<uint8_t> edges(40, 40, 0);
  for (int i = 0; i < 8; ++i) {
    edges(10 + i, 20) = 1;
  }
  HoughOptions options;
  options.min_votes = 9;
  EXPECT_TRUE(Detect(edges, options).empty());
  options.min_votes = 5;
  EXPECT_FALSE(Detect(edges, options).empty());
}

TEST(LineSegments, FollowSlantedLines) {
  for (const double angle : {0.2, 0.7854, 1.3, 2.0, 2.8}) {
    Image<uint8_t> edges(160, 160, 0);
    int num_edges = 0;
    for (double t = -60.0; t <= 60.0; t += 0.25) {
      uint8_t& edge =
          edges(static_cast<int>(std::lround(80.0 + t * std::cos(angle))),
                static_cast<int>(std::lround(80.0 + t * std::sin(angle))));
      num_edges += edge == 0 ? 1 : 0;
      edge = 1;
    }
    const Image<uint8_t> covered = Cover(edges);
    int num_covered = 0;
    int num_wrong = 0;
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 160; ++x) {
        const double distance = std::abs((y - 80.0) * std::cos(angle) -
                                         (x - 80.0) * std::sin(angle));
        num_covered += covered(x, y) && edges(x, y) ? 1 : 0;
        num_wrong += covered(x, y) && distance > 2.0 ? 1 : 0;
      }
    }
    EXPECT_GT(num_covered, 0.8 * num_edges) << angle;
    EXPECT_EQ(num_wrong, 0) << angle;
  }
}

TEST(LineSegments, OfNothingAreNone) {
  EXPECT_TRUE(Detect(Image<uint8_t>(50, 40, 0)).empty());
  EXPECT_TRUE(Detect(Image<uint8_t>(1, 1, 0)).empty());
}

TEST(LineSegments, CopeWithAnImageOfEdgesOnly) {
  for (const auto& [width, height] : {std::pair(90, 70),
                                      std::pair(1, 1),
                                      std::pair(1, 60),
                                      std::pair(60, 1)}) {
    const Image<uint8_t> edges(width, height, 1);
    for (const LineSegment& segment : Detect(edges)) {
      ASSERT_TRUE(edges.Contains(segment.x0, segment.y0));
      ASSERT_TRUE(edges.Contains(segment.x1, segment.y1));
    }
  }
  EXPECT_FALSE(Detect(Image<uint8_t>(90, 70, 1)).empty());
}

TEST(LineSegments, AreTheSameForTheSameImage) {
  Image<uint8_t> edges(120, 90, 0);
  Philox random(1, 0, 0);
  for (uint8_t& edge : edges) {
    edge = random.NextBelow(6) == 0 ? 1 : 0;
  }
  const auto equal = [](const LineSegment& a, const LineSegment& b) {
    return a.x0 == b.x0 && a.y0 == b.y0 && a.x1 == b.x1 && a.y1 == b.y1;
  };
  const std::vector<LineSegment> first = Detect(edges);
  const std::vector<LineSegment> second = Detect(edges);
  ASSERT_FALSE(first.empty());
  EXPECT_TRUE(std::equal(
      first.begin(), first.end(), second.begin(), second.end(), equal));
}

TEST(DrawLineSegments, HasNoGapsInAnyDirection) {
  for (int x1 = 0; x1 < 30; x1 += 3) {
    for (const int y1 : {0, 7, 29}) {
      Image<uint8_t> edges(30, 30, 0);
      DrawLineSegments({{15, 15, x1, y1}}, edges.View());
      const int expected = std::max(std::abs(x1 - 15), std::abs(y1 - 15)) + 1;
      EXPECT_EQ(std::count(edges.begin(), edges.end(), 1), expected);
      EXPECT_EQ(edges(15, 15), 1);
      EXPECT_EQ(edges(x1, y1), 1);
    }
  }
}

}  // namespace
}  // namespace tsar
