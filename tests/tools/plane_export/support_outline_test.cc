// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// From how views cover a plane to the polygons of its support.

#include "colmap_tsar/tools/plane_export/support_mask.h"
#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kCell = 0.5;
const Eigen::Vector2d kCorner(10.0, -20.0);

Eigen::Vector2d PointAt(double x, double y) {
  return kCorner + kCell * Eigen::Vector2d(x, y);
}

struct Cover {
  std::array<int, 4> cells;  // x, y, width, height.
  float coverage;
};

SupportGrid MakeGrid(const std::vector<Cover>& covers) {
  SupportGrid grid;
  grid.corner = kCorner;
  grid.cell = kCell;
  grid.coverage = Image<float>(100, 80);
  for (const auto& [cells, coverage] : covers) {
    for (int y = cells[1]; y < cells[1] + cells[3]; ++y) {
      for (int x = cells[0]; x < cells[0] + cells[2]; ++x) {
        grid.coverage(x, y) = coverage;
      }
    }
  }
  return grid;
}

std::vector<PlanePolygon> Trace(const SupportGrid& grid,
                                const std::vector<CreaseLine>& creases) {
  return TracePolygons(grid, FindSupport(grid, creases), creases);
}

// The vertical crease at x, along `length` cells.
CreaseLine CreaseAt(double x, double length = 80) {
  return {PointAt(x, 0), {0, 1}, 0.0, length * kCell};
}

// A part of the support: its area in cells, the number of its corners (0: any)
// and holes.
struct Part {
  double area;
  size_t num_corners;
  size_t num_holes;
};

TEST(TracePolygons, FollowsTheSupport) {
  struct Case {
    std::string name;
    std::vector<Cover> covers;
    std::vector<CreaseLine> creases;
    std::vector<Part> parts;  // The largest first.
  };
  const CreaseLine level = {PointAt(0, 61.2), {1, 0}, 0.0, 100 * kCell};
  const Case cases[] = {
      {"nothing", {}, {}, {}},
      {"a rectangle", {{{10, 20, 30, 40}, 3.f}}, {}, {{1200, 4, 0}}},
      {"a hole and two parts",
       {{{10, 20, 40, 40}, 3.f},
        {{25, 35, 10, 12}, 0.f},
        {{70, 30, 20, 20}, 1.f}},
       {},
       {{1480, 4, 1}, {400, 4, 0}}},
      {"what few see where many look",
       {{{10, 20, 30, 40}, 20.f},
        {{60, 20, 20, 20}, 1.f},
        {{9, 20, 1, 40}, 8.f}},
       {},
       {{1200, 4, 0}}},
      {"a gap, a small hole and a small island",
       {{{10, 20, 40, 40}, 1.f},
        {{30, 20, 4, 40}, 0.f},
        {{15, 25, 3, 3}, 0.f},
        {{70, 70, 3, 3}, 1.f}},
       {},
       {{1600, 4, 0}}},
      {"little beyond a crease",
       {{{10, 20, 40, 40}, 1.f}, {{50, 30, 2, 5}, 1.f}},
       {CreaseAt(49.3)},
       {{39.3 * 40, 4, 0}}},
      {"two creases that meet in a corner",
       {{{10, 20, 40, 40}, 1.f}},
       {CreaseAt(49.3), level},
       {{39.3 * 41.2, 4, 0}}},
      // A floor continues beside the wall that stands on it.
      {"a crease in its midst",
       {{{10, 20, 40, 40}, 1.f}},
       {CreaseAt(30)},
       {{1600, 0, 0}}},
      {"beside the end of a crease",
       {{{10, 20, 40, 40}, 1.f}},
       {CreaseAt(49.3, 5)},
       {{1600, 4, 0}}},
  };
  for (const Case& of : cases) {
    SCOPED_TRACE(of.name);
    const std::vector<PlanePolygon> polygons =
        Trace(MakeGrid(of.covers), of.creases);
    ASSERT_EQ(polygons.size(), of.parts.size());
    for (size_t i = 0; i < polygons.size(); ++i) {
      const Part& part = of.parts[i];
      EXPECT_NEAR(polygons[i].area, part.area * kCell * kCell, 1e-9);
      EXPECT_EQ(polygons[i].holes.size(), part.num_holes);
      if (part.num_corners > 0) {
        EXPECT_EQ(polygons[i].outline.size(), part.num_corners);
      }
    }
  }
}

TEST(TracePolygons, SlantedBordersNeedFewCorners) {
  std::vector<Cover> covers;
  for (int y = 10; y < 70; ++y) {
    covers.push_back({{5 + y / 3, y, 60, 1}, 1.f});
  }
  const std::vector<PlanePolygon> polygons = Trace(MakeGrid(covers), {});
  ASSERT_EQ(polygons.size(), 1u);
  EXPECT_LE(polygons[0].outline.size(), 6u);
  EXPECT_NEAR(polygons[0].area, 3600 * kCell * kCell, 0.03 * 900);
}

bool Cross(const Eigen::Vector2d& a,
           const Eigen::Vector2d& b,
           const Eigen::Vector2d& c,
           const Eigen::Vector2d& d) {
  const auto side = [](const auto& from, const auto& to, const auto& point) {
    return tsar::Cross(to - from, point - from);
  };
  return side(a, b, c) * side(a, b, d) < 0.0 &&
         side(c, d, a) * side(c, d, b) < 0.0;
}

// Whatever is covered, no edges cross, and the area is about right.
TEST(TracePolygons, ChaosGivesSimplePolygons) {
  for (int period = 2; period < 9; ++period) {
    SCOPED_TRACE(period);
    SupportGrid grid = MakeGrid({});
    for (int y = 4; y < 76; ++y) {
      for (int x = 4; x < 96; ++x) {
        const int number = (x / period) * 7919 + (y / period) * 104729;
        grid.coverage(x, y) = number % 5 < 3 ? 1.f : 0.f;
      }
    }
    const auto num_cells = std::ranges::count_if(
        FindSupport(grid, {}), [](uint8_t value) { return value != 0; });
    double area = 0.0;
    for (const PlanePolygon& polygon : Trace(grid, {})) {
      area += polygon.area;
      std::vector<std::array<Eigen::Vector2d, 2>> edges;
      std::vector<Ring> rings = polygon.holes;
      rings.push_back(polygon.outline);
      for (const Ring& ring : rings) {
        for (size_t i = 0; i < ring.size(); ++i) {
          edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
        }
      }
      int num_crossings = 0;
      for (const auto& [a, b] : edges) {
        for (const auto& [c, d] : edges) {
          num_crossings += Cross(a, b, c, d) ? 1 : 0;
        }
      }
      EXPECT_EQ(num_crossings, 0);
    }
    EXPECT_NEAR(
        area, static_cast<double>(num_cells) * kCell * kCell, 0.12 * area);
  }
}

}  // namespace
}  // namespace tsar
