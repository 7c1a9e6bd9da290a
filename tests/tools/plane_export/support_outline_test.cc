// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// From how views cover a plane to the polygons of its support.

#include "colmap_tsar/tools/plane_export/support_mask.h"
#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kCell = 0.5;

class SupportOutlineTest : public testing::Test {
 protected:
  SupportOutlineTest() {
    grid_.corner = {10.0, -20.0};
    grid_.cell = kCell;
    grid_.coverage = Image<float>(100, 80);
  }
  // Cells from (x, y) on.
  void Cover(int x, int y, int width, int height, float coverage) {
    for (int row = y; row < y + height; ++row) {
      for (int column = x; column < x + width; ++column) {
        grid_.coverage(column, row) = coverage;
      }
    }
  }
  std::vector<PlanePolygon> Trace() const {
    return TracePolygons(grid_, FindSupport(grid_, creases_), creases_);
  }
  Eigen::Vector2d Corner(double x, double y) const {
    return grid_.corner + kCell * Eigen::Vector2d(x, y);
  }

  SupportGrid grid_;
  std::vector<CreaseLine> creases_;
};

TEST_F(SupportOutlineTest, FollowsTheCells) {
  Cover(10, 20, 30, 40, 3.f);
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons[0].outline.size(), 4u);
  EXPECT_TRUE(polygons[0].holes.empty());
  EXPECT_NEAR(Area(polygons[0]), 30 * 40 * kCell * kCell, 1e-9);
}

TEST_F(SupportOutlineTest, KeepsHolesAndParts) {
  Cover(10, 20, 40, 40, 3.f);
  Cover(25, 35, 10, 12, 0.f);
  Cover(70, 30, 20, 20, 1.f);
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 2u);
  ASSERT_EQ(polygons[0].holes.size(), 1u);
  EXPECT_NEAR(SignedArea(polygons[0].holes[0]), -120 * kCell * kCell, 1e-9);
  EXPECT_NEAR(Area(polygons[1]), 400 * kCell * kCell, 1e-9);
  for (const PlanePolygon& polygon : polygons) {
    EXPECT_TRUE(IsSimple(polygon));
  }
}

TEST_F(SupportOutlineTest, DropsWhatIsHardlyCovered) {
  // By wrong labels, where many views look, and along the border of a wall.
  Cover(10, 20, 30, 40, 20.f);
  Cover(60, 20, 20, 20, 1.f);
  Cover(9, 20, 1, 40, 8.f);
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_NEAR(Area(polygons[0]), 30 * 40 * kCell * kCell, 1e-9);
}

TEST_F(SupportOutlineTest, ClosesGapsAndDropsSpecks) {
  Cover(10, 20, 40, 40, 1.f);
  Cover(30, 20, 4, 40, 0.f);  // A gap through all of it.
  Cover(15, 25, 3, 3, 0.f);   // A small hole.
  Cover(70, 70, 3, 3, 1.f);   // A small island.
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_TRUE(polygons[0].holes.empty());
  EXPECT_NEAR(Area(polygons[0]), 1600 * kCell * kCell, 1e-9);
}

TEST_F(SupportOutlineTest, EndsAtACrease) {
  Cover(10, 20, 40, 40, 1.f);
  Cover(50, 30, 2, 5, 1.f);  // Beyond the crease at 49.3.
  creases_.push_back({Corner(49.3, 0), {0, 1}, 0.0, 80 * kCell});
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_EQ(polygons[0].outline.size(), 4u);
  EXPECT_NEAR(Area(polygons[0]), 39.3 * 40 * kCell * kCell, 1e-9);
}

TEST_F(SupportOutlineTest, CreasesMeetInACorner) {
  Cover(10, 20, 40, 40, 1.f);
  creases_.push_back({Corner(49.3, 0), {0, 1}, 0.0, 80 * kCell});
  creases_.push_back({Corner(0, 61.2), {1, 0}, 0.0, 100 * kCell});
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  bool has_corner = false;
  for (const Eigen::Vector2d& point : polygons[0].outline) {
    has_corner |= (point - Corner(49.3, 61.2)).norm() < 1e-9;
  }
  EXPECT_TRUE(has_corner);
}

// A floor goes on beside the wall that stands on it.
TEST_F(SupportOutlineTest, GoesOnBeyondACreaseInItsMidst) {
  Cover(10, 20, 40, 40, 1.f);
  creases_.push_back({Corner(30, 0), {0, 1}, 0.0, 80 * kCell});
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_NEAR(Area(polygons[0]), 1600 * kCell * kCell, 1e-9);
}

// A crease counts only where it was seen.
TEST_F(SupportOutlineTest, GoesOnBesideTheEndOfACrease) {
  Cover(10, 20, 40, 40, 1.f);
  creases_.push_back({Corner(49.3, 0), {0, 1}, 0.0, 5 * kCell});
  EXPECT_NEAR(Area(Trace()[0]), 1600 * kCell * kCell, 1e-9);
}

TEST_F(SupportOutlineTest, SlantedBordersNeedFewCorners) {
  for (int y = 10; y < 70; ++y) {
    Cover(5 + y / 3, y, 60, 1, 1.f);
  }
  const std::vector<PlanePolygon> polygons = Trace();
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_LE(polygons[0].outline.size(), 6u);
  EXPECT_NEAR(Area(polygons[0]), 3600 * kCell * kCell, 0.03 * 900);
}

// Whatever is covered, polygons are simple, and have about the right area.
TEST_F(SupportOutlineTest, ChaosGivesSimplePolygons) {
  for (int period = 2; period < 9; ++period) {
    for (int y = 4; y < 76; ++y) {
      for (int x = 4; x < 96; ++x) {
        const int number = (x / period) * 7919 + (y / period) * 104729;
        grid_.coverage(x, y) = number % 5 < 3 ? 1.f : 0.f;
      }
    }
    const Image<uint8_t> support = FindSupport(grid_, {});
    double num_cells = 0.0;
    for (const uint8_t value : support) {
      num_cells += value != 0 ? 1.0 : 0.0;
    }
    double area = 0.0;
    for (const PlanePolygon& polygon : Trace()) {
      EXPECT_TRUE(IsSimple(polygon));
      area += Area(polygon);
    }
    EXPECT_NEAR(area, num_cells * kCell * kCell, 0.12 * area) << period;
  }
}

TEST_F(SupportOutlineTest, NothingGivesNothing) {
  EXPECT_TRUE(Trace().empty());
}

}  // namespace
}  // namespace tsar
