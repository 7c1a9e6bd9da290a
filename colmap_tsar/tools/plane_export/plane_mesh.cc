// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>

namespace tsar {
namespace {

using Loop = std::vector<int>;  // Indices of points, counterclockwise.

// Positive if a, b, c turn left, 0 if they are collinear.
double Turn(const Eigen::Vector2d& a,
            const Eigen::Vector2d& b,
            const Eigen::Vector2d& c) {
  return Cross(b - a, c - a);
}

// Whether a point lies in a triangle or on its border.
bool IsInTriangle(const Eigen::Vector2d& point,
                  const Eigen::Vector2d& a,
                  const Eigen::Vector2d& b,
                  const Eigen::Vector2d& c) {
  return Turn(a, b, point) >= 0.0 && Turn(b, c, point) >= 0.0 &&
         Turn(c, a, point) >= 0.0;
}

// Whether a point lies left of both edges or, in a right turn, of either.
bool IsInCorner(const Eigen::Vector2d& before,
                const Eigen::Vector2d& corner,
                const Eigen::Vector2d& after,
                const Eigen::Vector2d& point) {
  const bool is_left_of_first = Turn(before, corner, point) > 0.0;
  const bool is_left_of_second = Turn(corner, after, point) > 0.0;
  return Turn(before, corner, after) < 0.0
             ? is_left_of_first || is_left_of_second
             : is_left_of_first && is_left_of_second;
}

const Eigen::Vector2d& At(const Ring& points, const Loop& loop, size_t i) {
  return points[loop[i % loop.size()]];
}

// The position in the loop of a point that can be joined to the hole's
// rightmost point without crossing the loop.
size_t FindBridge(const Ring& points,
                  const Loop& loop,
                  const Eigen::Vector2d& rightmost) {
  // The edge that a ray to the right hits first; it runs upwards there.
  double nearest = std::numeric_limits<double>::infinity();
  size_t bridge = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d& a = At(points, loop, i);
    const Eigen::Vector2d& b = At(points, loop, i + 1);
    if (a.y() > rightmost.y() || b.y() < rightmost.y() || a.y() == b.y()) {
      continue;
    }
    const double x =
        a.x() + (rightmost.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (x >= rightmost.x() && x < nearest) {
      nearest = x;
      bridge = a.x() > b.x() ? i : (i + 1) % loop.size();
    }
  }
  // Points in the triangle between the ray and that edge's end occlude it; of
  // these, the one nearest to the ray's direction is visible.
  const Eigen::Vector2d hit(nearest, rightmost.y());
  Eigen::Vector2d end = At(points, loop, bridge);
  const bool is_above = end.y() > rightmost.y();
  const Eigen::Vector2d& a = rightmost;
  const Eigen::Vector2d b = is_above ? hit : end;
  const Eigen::Vector2d c = is_above ? end : hit;
  double best_slope = std::numeric_limits<double>::infinity();
  double best_distance = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < loop.size(); ++i) {
    const Eigen::Vector2d& point = At(points, loop, i);
    if (point.x() < rightmost.x() || !IsInTriangle(point, a, b, c) ||
        point == rightmost) {
      continue;
    }
    // Points where loops touch themselves occur several times; the occurrence
    // whose corner holds the bridge is chosen.
    const Eigen::Vector2d& before = At(points, loop, i + loop.size() - 1);
    const Eigen::Vector2d& after = At(points, loop, i + 1);
    const bool is_inside = IsInCorner(before, point, after, rightmost);

    const double width = point.x() - rightmost.x();
    const double height = std::abs(point.y() - rightmost.y());
    const double slope = height == 0.0 ? 0.0 : height / width;
    const double distance = (point - rightmost).squaredNorm();
    if (is_inside && (slope < best_slope ||
                      (slope == best_slope && distance < best_distance))) {
      best_slope = slope;
      best_distance = distance;
      bridge = i;
    }
  }
  return bridge;
}

Loop::const_iterator Rightmost(const Ring& points, const Loop& hole) {
  return std::ranges::max_element(
      hole, {}, [&](int i) { return points[i].x(); });
}

void JoinHole(const Ring& points, const Loop& hole, Loop* loop) {
  const auto rightmost = Rightmost(points, hole);
  const size_t bridge = FindBridge(points, *loop, points[*rightmost]);
  // Along the bridge, around the hole, and back.
  Loop inserted(rightmost, hole.end());
  inserted.insert(inserted.end(), hole.begin(), rightmost);
  inserted.push_back(*rightmost);
  inserted.push_back((*loop)[bridge]);
  loop->insert(loop->begin() + static_cast<std::ptrdiff_t>(bridge) + 1,
               inserted.begin(),
               inserted.end());
}

bool IsEar(const Ring& points, const Loop& loop, size_t i) {
  const Eigen::Vector2d& a = At(points, loop, i + loop.size() - 1);
  const Eigen::Vector2d& b = At(points, loop, i);
  const Eigen::Vector2d& c = At(points, loop, i + 1);
  if (!(Turn(a, b, c) > 0.0)) {
    return false;
  }
  return std::ranges::none_of(loop, [&](int number) {
    const Eigen::Vector2d& point = points[number];
    return point != a && point != b && point != c &&
           IsInTriangle(point, a, b, c);
  });
}

void CutEars(const Ring& points,
             Loop loop,
             std::vector<std::array<int, 3>>* triangles) {
  size_t i = 0;
  size_t num_tried = 0;
  while (loop.size() >= 3) {
    // Rounding may leave no ear: the next convex corner is cut, or any.
    const bool is_stuck = num_tried > loop.size();
    const bool is_lost = num_tried > 2 * loop.size();
    i %= loop.size();

    const double turn = Turn(At(points, loop, i + loop.size() - 1),
                             At(points, loop, i),
                             At(points, loop, i + 1));
    if (!is_lost && turn != 0.0 && !IsEar(points, loop, i) &&
        !(is_stuck && turn > 0.0)) {
      ++i;
      ++num_tried;
      continue;
    }
    if (turn > 0.0) {
      triangles->push_back({loop[(i + loop.size() - 1) % loop.size()],
                            loop[i],
                            loop[(i + 1) % loop.size()]});
    }
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(i));
    // The next corner is skipped, which avoids fans of thin triangles.
    ++i;
    num_tried = 0;
  }
}

}  // namespace

Triangulation Triangulate(const PlanePolygon& polygon) {
  Triangulation result;
  result.points = polygon.outline;
  Loop loop(polygon.outline.size());
  std::iota(loop.begin(), loop.end(), 0);
  std::vector<Loop> holes;
  for (const Ring& ring : polygon.holes) {
    Loop& hole = holes.emplace_back(ring.size());
    std::iota(hole.begin(), hole.end(), static_cast<int>(result.points.size()));
    result.points.insert(result.points.end(), ring.begin(), ring.end());
  }

  // Right holes go first, so that no hole lies between another and the loop.
  std::ranges::stable_sort(holes, std::greater(), [&](const Loop& hole) {
    return result.points[*Rightmost(result.points, hole)].x();
  });
  for (const Loop& hole : holes) {
    JoinHole(result.points, hole, &loop);
  }
  CutEars(result.points, std::move(loop), &result.triangles);
  return result;
}

PlaneMesh MakePlaneMesh(const ExportedPlane& plane) {
  PlaneMesh mesh;
  for (const PlanePolygon& polygon : plane.polygons) {
    const Triangulation triangulation = Triangulate(polygon);
    const int first = static_cast<int>(mesh.points.size());
    for (const Eigen::Vector2d& point : triangulation.points) {
      mesh.points.push_back(plane.coordinates.ToWorld(point));
    }
    for (const auto& [a, b, c] : triangulation.triangles) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return mesh;
}

std::string NumberText(double number) {
  char text[32];
  const std::to_chars_result result =
      std::to_chars(text, text + sizeof(text), number);
  return std::string(text, result.ptr);
}

std::string PointText(const Eigen::Vector3d& point) {
  return NumberText(point.x()) + " " + NumberText(point.y()) + " " +
         NumberText(point.z());
}

}  // namespace tsar
