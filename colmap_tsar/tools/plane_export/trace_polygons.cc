// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Boost is to compute with the coordinates as they are, not scaled to integers.
#define BOOST_GEOMETRY_NO_ROBUSTNESS

#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>

#include <boost/geometry/algorithms/area.hpp>
#include <boost/geometry/algorithms/correct.hpp>
#include <boost/geometry/algorithms/is_valid.hpp>
#include <boost/geometry/algorithms/simplify.hpp>
#include <boost/geometry/geometries/point_xy.hpp>
#include <boost/geometry/geometries/polygon.hpp>
#include <boost/geometry/strategies/strategies.hpp>
#include <boost/polygon/polygon.hpp>

namespace tsar {
namespace {

// Tolerance of the simplification, in cells.
constexpr double kTolerance = 1.5;
constexpr double kMaxToCrease = 2.0;
constexpr double kMaxToCorner = 3.5;
constexpr double kCreaseMargin = 3.0;
constexpr double kMaxStraight = 1e-6;

namespace bg = boost::geometry;
namespace bp = boost::polygon;

// Counterclockwise, and closed by a copy of the first point.
using BoostPoint = bg::model::d2::point_xy<double>;
using BoostPolygon = bg::model::polygon<BoostPoint, /*ClockWise=*/false, true>;
using BoostRing = BoostPolygon::ring_type;

// The borders of parts of a support, in cells.
using Borders = bp::polygon_90_with_holes_data<int>;

std::vector<Borders> FindBorders(const Image<uint8_t>& support) {
  bp::polygon_90_set_data<int> cells;
  for (int y = 0; y < support.Height(); ++y) {
    for (int x = 0; x < support.Width(); ++x) {
      const int begin = x;
      while (x < support.Width() && support(x, y) != 0) {
        ++x;
      }
      if (x > begin) {
        cells.insert(bp::rectangle_data<int>(begin, y, x, y + 1));
      }
    }
  }
  std::vector<Borders> borders;
  cells.get(borders);
  return borders;
}

std::optional<Eigen::Vector2d> MeetingPoint(const CreaseLine& a,
                                            const CreaseLine& b) {
  if (std::abs(Cross(a.direction, b.direction)) < kMinSine) {
    return std::nullopt;
  }
  return a.point -
         b.Height(a.point) / b.Height(b.point + a.direction) * a.direction;
}

Eigen::Vector2d PutOntoCreases(const Eigen::Vector2d& point,
                               double cell,
                               const std::vector<CreaseLine>& creases) {
  const auto distance = [&](const CreaseLine* crease) {
    return std::abs(crease->Height(point));
  };
  std::vector<const CreaseLine*> near;
  for (const CreaseLine& crease : creases) {
    if (distance(&crease) <= kMaxToCrease * cell &&
        crease.IsBeside(point, kCreaseMargin * cell)) {
      near.push_back(&crease);
    }
  }
  if (near.empty()) {
    return point;
  }
  std::ranges::stable_sort(near, {}, distance);
  for (size_t i = 1; i < near.size(); ++i) {
    const std::optional<Eigen::Vector2d> corner =
        MeetingPoint(*near[0], *near[i]);
    if (corner && (*corner - point).norm() <= kMaxToCorner * cell) {
      return *corner;
    }
  }
  return near[0]->point + near[0]->Along(point) * near[0]->direction;
}

BoostRing Simplify(const BoostRing& ring, double tolerance) {
  BoostRing simplified;
  bg::simplify(ring, simplified, tolerance);
  return simplified;
}

// The ring of a border: simplified, at creases where some are near, and without
// corners on straight lines.
template <typename Border>
BoostRing ToRing(const Border& border,
                 double tolerance,
                 const SupportGrid& grid,
                 const std::vector<CreaseLine>& creases) {
  BoostRing ring;
  for (const bp::point_data<int>& corner : border) {
    ring.emplace_back(corner.x(), corner.y());
  }
  bg::correct(ring);  // Closes it.
  ring = Simplify(ring, tolerance);
  for (BoostPoint& at : ring) {
    const Eigen::Vector2d point = PutOntoCreases(
        grid.corner + grid.cell * Eigen::Vector2d(at.x(), at.y()),
        grid.cell,
        creases);
    at = {point.x(), point.y()};
  }
  return Simplify(ring, kMaxStraight * grid.cell);
}

BoostPolygon ToPolygon(const Borders& borders,
                       double tolerance,
                       const SupportGrid& grid,
                       const std::vector<CreaseLine>& creases) {
  BoostPolygon polygon;
  polygon.outer() = ToRing(borders, tolerance, grid, creases);
  for (auto hole = borders.begin_holes(); hole != borders.end_holes(); ++hole) {
    BoostRing ring = ToRing(*hole, tolerance, grid, creases);
    // Degenerate rings are small and dropped.
    if (ring.size() > 3) {
      polygon.inners().push_back(std::move(ring));
    }
  }
  bg::correct(polygon);  // Turns its rings.
  return polygon;
}

// The simplest polygon without crossings; the full borders have none.
BoostPolygon SimplestPolygon(const Borders& borders,
                             const SupportGrid& grid,
                             const std::vector<CreaseLine>& creases) {
  for (const double tolerance : {kTolerance, 0.5 * kTolerance}) {
    for (const std::vector<CreaseLine>& lines :
         {creases, std::vector<CreaseLine>()}) {
      BoostPolygon polygon = ToPolygon(borders, tolerance, grid, lines);
      if (bg::is_valid(polygon)) {
        return polygon;
      }
    }
  }
  return ToPolygon(borders, 0.0, grid, {});
}

Ring WithoutLast(const BoostRing& closed) {
  Ring ring;
  for (size_t i = 0; i + 1 < closed.size(); ++i) {
    ring.emplace_back(closed[i].x(), closed[i].y());
  }
  return ring;
}

}  // namespace

std::vector<PlanePolygon> TracePolygons(
    const SupportGrid& grid,
    const Image<uint8_t>& support,
    const std::vector<CreaseLine>& creases) {
  std::vector<PlanePolygon> polygons;
  for (const Borders& borders : FindBorders(support)) {
    const BoostPolygon simplest = SimplestPolygon(borders, grid, creases);
    PlanePolygon& polygon = polygons.emplace_back();
    polygon.outline = WithoutLast(simplest.outer());
    std::ranges::transform(
        simplest.inners(), std::back_inserter(polygon.holes), &WithoutLast);
    polygon.area = bg::area(simplest);
  }
  std::ranges::stable_sort(polygons, std::greater(), &PlanePolygon::area);
  return polygons;
}

}  // namespace tsar
