// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_polygon.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

const Ring kSquare = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
const Ring kHole = {{1, 1}, {1, 2}, {2, 2}, {2, 1}};

TEST(PlanePolygon, HasAreaWithoutHoles) {
  EXPECT_EQ(SignedArea(kSquare), 16.0);
  EXPECT_EQ(SignedArea(kHole), -1.0);
  EXPECT_EQ(Area({kSquare, {kHole}}), 15.0);
  EXPECT_EQ(SignedArea({}), 0.0);
}

TEST(PlanePolygon, SimpleOnesDoNotTouchThemselves) {
  EXPECT_TRUE(IsSimple({kSquare, {}}));
  EXPECT_TRUE(IsSimple({kSquare, {kHole}}));
  // Corners on a line are no fault.
  EXPECT_TRUE(IsSimple({{{0, 0}, {2, 0}, {4, 0}, {4, 4}, {0, 4}}, {}}));
  const Ring bow_tie = {{0, 0}, {4, 4}, {4, 0}, {0, 4}};
  EXPECT_FALSE(IsSimple({bow_tie, {}}));
  const Ring spike = {{0, 0}, {4, 0}, {2, 0}, {2, 4}};
  EXPECT_FALSE(IsSimple({spike, {}}));
  const Ring pinched = {{0, 0}, {4, 0}, {2, 2}, {4, 4}, {0, 4}, {2, 2}};
  EXPECT_FALSE(IsSimple({pinched, {}}));
  EXPECT_FALSE(IsSimple({{{0, 0}, {1, 1}}, {}}));
  EXPECT_FALSE(IsSimple({kSquare, {{{1, 1}, {2, 2}}}}));
  // A hole that reaches out, one that touches, and two that overlap.
  EXPECT_FALSE(IsSimple({kSquare, {{{1, 1}, {1, 2}, {5, 2}}}}));
  EXPECT_FALSE(IsSimple({kSquare, {{{1, 1}, {1, 2}, {4, 2}}}}));
  EXPECT_FALSE(IsSimple({kSquare, {kHole, {{1.5, 1.5}, {1.5, 3}, {3, 3}}}}));
}

}  // namespace
}  // namespace tsar
