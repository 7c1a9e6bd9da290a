// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/trace_polygons.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// Tolerance of the simplification, in cells.
constexpr double kTolerance = 1.5;
constexpr double kMaxToCrease = 2.0;
constexpr double kMaxToCorner = 3.5;
constexpr double kCreaseMargin = 3.0;
constexpr double kMaxStraight = 1e-6;

using Contour = std::vector<cv::Point>;

struct Contours {
  Contour outline;
  std::vector<Contour> holes;
};

// Adds the corners that contours skip at protrusions of the outside.
Contour WithCorners(const Contour& contour, const cv::Mat& nodes) {
  Contour result;
  for (size_t i = 0; i < contour.size(); ++i) {
    const cv::Point from = contour[i];
    const cv::Point to = contour[(i + 1) % contour.size()];
    result.push_back(from);
    if (std::abs(to.x - from.x) == 1 && std::abs(to.y - from.y) == 1) {
      const cv::Point corner(from.x, to.y);
      result.push_back(
          nodes.at<uint8_t>(corner) != 0 ? corner : cv::Point(to.x, from.y));
    }
  }
  return result;
}

// Finds contours in a grid of nodes, three along each side of a cell, the outer
// two shared with its neighbors: so a contour, which runs through the outermost
// inner points, follows the cells' borders.
std::vector<Contours> FindContours(const Image<uint8_t>& support) {
  cv::Mat nodes = cv::Mat::zeros(
      2 * support.Height() + 1, 2 * support.Width() + 1, CV_8UC1);
  for (int y = 0; y < support.Height(); ++y) {
    for (int x = 0; x < support.Width(); ++x) {
      if (support(x, y) != 0) {
        nodes(cv::Rect(2 * x, 2 * y, 3, 3)).setTo(255);
      }
    }
  }
  std::vector<Contour> all;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(
      nodes, all, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_SIMPLE);
  std::vector<Contours> contours;
  constexpr int kNext = 0;
  constexpr int kFirstChild = 2;
  for (int i = all.empty() ? -1 : 0; i >= 0; i = hierarchy[i][kNext]) {
    contours.emplace_back().outline = WithCorners(all[i], nodes);
    for (int hole = hierarchy[i][kFirstChild]; hole >= 0;
         hole = hierarchy[hole][kNext]) {
      contours.back().holes.push_back(WithCorners(all[hole], nodes));
    }
  }
  return contours;
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

// Removes corners between their neighbors on a line, or on one of them.
void RemoveStraightCorners(double max_distance, Ring* ring) {
  bool has_changed = true;
  while (has_changed && ring->size() >= 3) {
    has_changed = false;
    for (size_t i = 0; i < ring->size() && ring->size() >= 3;) {
      const Eigen::Vector2d& before =
          (*ring)[(i + ring->size() - 1) % ring->size()];
      const Eigen::Vector2d& after = (*ring)[(i + 1) % ring->size()];
      const Eigen::Vector2d& corner = (*ring)[i];
      const double length = (after - before).norm();
      const double twice_area =
          std::abs(SignedArea({before, corner, after})) * 2.0;
      const bool is_between = (corner - before).dot(corner - after) <= 0.0;
      if (corner == before ||
          (is_between && twice_area <= max_distance * length)) {
        ring->erase(ring->begin() + static_cast<std::ptrdiff_t>(i));
        has_changed = true;
      } else {
        ++i;
      }
    }
  }
}

Ring ToRing(const Contour& contour,
            double tolerance,
            bool is_hole,
            const SupportGrid& grid,
            const std::vector<CreaseLine>& creases) {
  Contour simplified = contour;
  if (tolerance > 0.0) {
    cv::approxPolyDP(contour, simplified, 2.0 * tolerance, true);
  }
  Ring ring;
  for (const cv::Point& node : simplified) {
    ring.push_back(PutOntoCreases(
        grid.corner + 0.5 * grid.cell * Eigen::Vector2d(node.x, node.y),
        grid.cell,
        creases));
  }
  RemoveStraightCorners(kMaxStraight * grid.cell, &ring);
  if ((SignedArea(ring) < 0.0) != is_hole) {
    std::reverse(ring.begin(), ring.end());
  }
  return ring;
}

PlanePolygon ToPolygon(const Contours& contours,
                       double tolerance,
                       const SupportGrid& grid,
                       const std::vector<CreaseLine>& creases) {
  PlanePolygon polygon;
  polygon.outline = ToRing(contours.outline, tolerance, false, grid, creases);
  for (const Contour& hole : contours.holes) {
    Ring ring = ToRing(hole, tolerance, true, grid, creases);
    // Degenerate rings are small and dropped.
    if (ring.size() >= 3) {
      polygon.holes.push_back(std::move(ring));
    }
  }
  return polygon;
}

// The simplest polygon without crossings; the full contour has none.
PlanePolygon SimplestPolygon(const Contours& contours,
                             const SupportGrid& grid,
                             const std::vector<CreaseLine>& creases) {
  for (const double tolerance : {kTolerance, 0.5 * kTolerance}) {
    for (const std::vector<CreaseLine>& lines :
         {creases, std::vector<CreaseLine>()}) {
      PlanePolygon polygon = ToPolygon(contours, tolerance, grid, lines);
      if (IsSimple(polygon)) {
        return polygon;
      }
    }
  }
  return ToPolygon(contours, 0.0, grid, {});
}

}  // namespace

std::vector<PlanePolygon> TracePolygons(
    const SupportGrid& grid,
    const Image<uint8_t>& support,
    const std::vector<CreaseLine>& creases) {
  std::vector<PlanePolygon> polygons;
  for (const Contours& contours : FindContours(support)) {
    polygons.push_back(SimplestPolygon(contours, grid, creases));
  }
  std::ranges::stable_sort(polygons, std::greater(), &Area);
  return polygons;
}

}  // namespace tsar
