// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_mesh.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tsar {
namespace {

Ring Rectangle(double x, double y, double width, double height) {
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

Ring Reversed(const Ring& ring) { return Ring(ring.rbegin(), ring.rend()); }

double AreaOf(const Ring& points, const std::array<int, 3>& triangle) {
  return SignedArea(
      {points[triangle[0]], points[triangle[1]], points[triangle[2]]});
}

// That the triangles are those of the polygon: none is turned, together they
// have its area, and their middles lie in it.
void ExpectToCover(const PlanePolygon& polygon) {
  ASSERT_TRUE(IsSimple(polygon));
  const Triangulation result = Triangulate(polygon);
  double area = 0.0;
  for (const std::array<int, 3>& triangle : result.triangles) {
    EXPECT_GT(AreaOf(result.points, triangle), 0.0);
    area += AreaOf(result.points, triangle);
    const Eigen::Vector2d middle =
        (result.points[triangle[0]] + result.points[triangle[1]] +
         result.points[triangle[2]]) /
        3.0;
    // Crossings of a ray to the right with all edges.
    int num_crossings = 0;
    const auto count = [&](const Ring& ring) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Eigen::Vector2d& a = ring[i];
        const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
        num_crossings += (a.y() > middle.y()) != (b.y() > middle.y()) &&
                         middle.x() < a.x() + (middle.y() - a.y()) /
                                                  (b.y() - a.y()) *
                                                  (b.x() - a.x());
      }
    };
    count(polygon.outline);
    for (const Ring& hole : polygon.holes) {
      count(hole);
    }
    EXPECT_EQ(num_crossings % 2, 1);
  }
  EXPECT_NEAR(area, Area(polygon), 1e-9 * Area(polygon));
}

TEST(Triangulate, CutsASquareInTwo) {
  const PlanePolygon square = {Rectangle(0, 0, 2, 2), {}};
  EXPECT_EQ(Triangulate(square).triangles.size(), 2u);
  ExpectToCover(square);
}

TEST(Triangulate, LeavesHolesOpen) {
  PlanePolygon polygon = {Rectangle(0, 0, 10, 10),
                          {Reversed(Rectangle(4, 4, 2, 2))}};
  EXPECT_EQ(Triangulate(polygon).triangles.size(), 8u);
  ExpectToCover(polygon);
  // At the same height, so that bridges run along edges, and in one column.
  polygon.holes.push_back(Reversed(Rectangle(1, 4, 2, 2)));
  polygon.holes.push_back(Reversed(Rectangle(7, 4, 2, 2)));
  polygon.holes.push_back(Reversed(Rectangle(7, 1, 2, 2)));
  polygon.holes.push_back(Reversed(Rectangle(7, 7, 2, 2)));
  ExpectToCover(polygon);
}

TEST(Triangulate, PointsOnALineCoverNothing) {
  ExpectToCover({{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}, {}});
}

TEST(Triangulate, CoversCombs) {
  Ring comb = {{0, 0}, {20, 0}};
  for (int i = 19; i >= 0; --i) {
    comb.push_back({i + 0.5, i % 2 == 0 ? 1.0 : 9.0});
  }
  ExpectToCover({comb, {}});
}

// Stars with stars as holes.
TEST(Triangulate, CoversDrawnPolygons) {
  for (uint32_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    Philox random(seed, 0, 0);
    const auto star = [&](const Eigen::Vector2d& middle, double radius) {
      Ring ring;
      const int num_points = 3 + static_cast<int>(20 * random.NextFloat());
      for (int i = 0; i < num_points; ++i) {
        const double angle = 2.0 * std::numbers::pi * i / num_points;
        const double length = radius * (0.3 + 0.7 * random.NextFloat());
        ring.push_back(middle + length * Eigen::Vector2d(std::cos(angle),
                                                         std::sin(angle)));
      }
      return ring;
    };
    PlanePolygon polygon;
    polygon.outline = star({0, 0}, 100.0);
    for (int i = 0; i < 6; ++i) {
      const double angle = i + random.NextFloat();
      const Eigen::Vector2d middle =
          60.0 * random.NextFloat() *
          Eigen::Vector2d(std::cos(angle), std::sin(angle));
      polygon.holes.push_back(Reversed(star(middle, 8.0)));
      const auto is_inside = [&] {
        // By the signs of crossings, that the hole is not beside the outline.
        int num_crossings = 0;
        for (size_t k = 0; k < polygon.outline.size(); ++k) {
          const Eigen::Vector2d& a = polygon.outline[k];
          const Eigen::Vector2d& b =
              polygon.outline[(k + 1) % polygon.outline.size()];
          num_crossings += (a.y() > middle.y()) != (b.y() > middle.y()) &&
                           middle.x() < a.x() + (middle.y() - a.y()) /
                                                    (b.y() - a.y()) *
                                                    (b.x() - a.x());
        }
        return num_crossings % 2 == 1;
      };
      // Nor in another hole, which lies apart where its middle is far enough.
      bool is_apart = true;
      for (size_t k = 0; k + 1 < polygon.holes.size(); ++k) {
        for (const Eigen::Vector2d& point : polygon.holes[k]) {
          is_apart &= (point - middle).norm() > 8.0;
        }
      }
      if (!is_apart || !is_inside() || !IsSimple(polygon)) {
        polygon.holes.pop_back();
      }
    }
    ExpectToCover(polygon);
  }
}

}  // namespace
}  // namespace tsar
