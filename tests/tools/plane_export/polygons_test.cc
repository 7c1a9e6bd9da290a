// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/plane_mesh.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
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

const Eigen::Vector3d kUp(0, 0, 1);

Eigen::Matrix3d Turn(double degrees) {
  return Eigen::AngleAxisd(degrees * 0.017453292519943295,
                           Eigen::Vector3d::UnitX())
      .toRotationMatrix();
}

TEST(FindVertical, TakesTheAxisNearTheCameras) {
  const Vertical vertical = FindVertical({kUp, Turn(30) * kUp}, {Turn(10)});
  EXPECT_EQ(vertical.source, Vertical::Source::kFrame);
  EXPECT_NEAR((vertical.up - Turn(10) * kUp).norm(), 0.0, 1e-12);
  // Also where it points down.
  const Vertical turned = FindVertical({kUp}, {Turn(180)});
  EXPECT_NEAR((turned.up - kUp).norm(), 0.0, 1e-12);
  EXPECT_EQ(ToString(turned.source), "manhattan_frame");
}

TEST(FindVertical, TakesTheNearestOfSeveralFrames) {
  const Vertical vertical = FindVertical({kUp}, {Turn(10), Turn(5), Turn(20)});
  EXPECT_NEAR((vertical.up - Turn(5) * kUp).norm(), 0.0, 1e-12);
}

TEST(FindVertical, TakesTheCamerasWhereNoAxisIsNear) {
  for (const std::vector<Eigen::Matrix3d>& frames :
       {std::vector<Eigen::Matrix3d>(), {Turn(45)}}) {
    const Vertical vertical =
        FindVertical({Turn(-8) * kUp, Turn(8) * kUp}, frames);
    EXPECT_EQ(vertical.source, Vertical::Source::kCameras);
    EXPECT_NEAR((vertical.up - kUp).norm(), 0.0, 1e-12);
  }
  EXPECT_EQ(ToString(Vertical::Source::kCameras), "cameras");
}

TEST(FindVertical, KnowsWhenNothingIsKnown) {
  for (const std::vector<Eigen::Vector3d>& ups :
       {std::vector<Eigen::Vector3d>(), {kUp, -kUp}}) {
    const Vertical vertical = FindVertical(ups, {Turn(0)});
    EXPECT_EQ(vertical.source, Vertical::Source::kNone);
    EXPECT_EQ(ClassifyPlane(kUp, {0, 0, 0}, {{0, 0, 1}}, vertical),
              PlaneClass::kOther);
  }
  EXPECT_EQ(ToString(Vertical::Source::kNone), "none");
}

TEST(ClassifyPlane, GoesByDirectionAndCameras) {
  const Vertical vertical = {kUp, Vertical::Source::kCameras};
  const auto classify = [&](double degrees, double camera) {
    // Either direction of a normal stands for the same plane.
    const Eigen::Vector3d normal = Turn(degrees) * kUp;
    const Eigen::Vector3d point(1, 0, 0);
    const std::vector<Eigen::Vector3d> cameras = {
        {1, 0, camera}, {1, 0, camera}, {1, 0, -camera}};
    const PlaneClass of_plane = ClassifyPlane(normal, point, cameras, vertical);
    EXPECT_EQ(ClassifyPlane(-normal, point, cameras, vertical), of_plane);
    return ToString(of_plane);
  };
  EXPECT_EQ(classify(0, 1), "floor");
  EXPECT_EQ(classify(14, 1), "floor");
  EXPECT_EQ(classify(14, -1), "ceiling");
  EXPECT_EQ(classify(16, 1), "other");
  EXPECT_EQ(classify(74, 1), "other");
  EXPECT_EQ(classify(76, 1), "wall");
  EXPECT_EQ(classify(104, -1), "wall");
}

}  // namespace
}  // namespace tsar
