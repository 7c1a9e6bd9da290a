// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace tsar {
namespace {

struct Edge {
  Eigen::Vector2d begin;
  Eigen::Vector2d end;
  size_t ring = 0;
  size_t index = 0;  // Index in its ring.

  double MinX() const { return std::min(begin.x(), end.x()); }
  double MaxX() const { return std::max(begin.x(), end.x()); }
};

// 1, 0 or -1: a point is left of an edge, on its line, or right of it.
int Side(const Edge& edge, const Eigen::Vector2d& point) {
  const double cross = Cross(edge.end - edge.begin, point - edge.begin);
  return cross > 0.0 ? 1 : cross < 0.0 ? -1 : 0;
}

bool IsInBox(const Edge& edge, const Eigen::Vector2d& point) {
  return (edge.begin.cwiseMin(edge.end).array() <= point.array()).all() &&
         (edge.begin.cwiseMax(edge.end).array() >= point.array()).all();
}

bool Meet(const Edge& a, const Edge& b) {
  const int begin_of_b = Side(a, b.begin);
  const int end_of_b = Side(a, b.end);
  const int begin_of_a = Side(b, a.begin);
  const int end_of_a = Side(b, a.end);
  return (begin_of_b * end_of_b < 0 && begin_of_a * end_of_a < 0) ||
         (begin_of_b == 0 && IsInBox(a, b.begin)) ||
         (end_of_b == 0 && IsInBox(a, b.end)) ||
         (begin_of_a == 0 && IsInBox(b, a.begin)) ||
         (end_of_a == 0 && IsInBox(b, a.end));
}

// Whether two edges that share a point overlap.
bool Overlap(const Edge& first, const Edge& second) {
  const Eigen::Vector2d a = first.end - first.begin;
  const Eigen::Vector2d b = second.end - second.begin;
  return Cross(a, b) == 0.0 && a.dot(b) <= 0.0;
}

void AppendEdges(const Ring& ring, size_t number, std::vector<Edge>* edges) {
  for (size_t i = 0; i < ring.size(); ++i) {
    edges->push_back({ring[i], ring[(i + 1) % ring.size()], number, i});
  }
}

}  // namespace

PlaneCoordinates CoordinatesOf(const ModelPlane& plane) {
  PlaneCoordinates coordinates;
  coordinates.normal = plane.plane.normal;
  coordinates.origin =
      plane.center - plane.plane.Height(plane.center) * plane.plane.normal;
  coordinates.axis_s = plane.axis_s;
  coordinates.axis_t = plane.plane.normal.cross(plane.axis_s);
  return coordinates;
}

PlaneProjection::PlaneProjection(const PlaneCoordinates& coordinates,
                                 const Camera& camera)
    : fx_(camera.fx),
      fy_(camera.fy),
      cx_(camera.cx),
      cy_(camera.cy),
      normal_(camera.rotation * coordinates.normal),
      offset_(coordinates.normal.dot(camera.Center() - coordinates.origin)),
      axis_s_(camera.rotation * coordinates.axis_s),
      axis_t_(camera.rotation * coordinates.axis_t),
      center_(coordinates.ToPlane(camera.Center())) {}

double PlaneProjection::Depth(const Eigen::Vector3d& ray) const {
  const double depth = -offset_ / normal_.dot(ray);
  return std::isfinite(depth) ? depth : 0.0;
}

Eigen::Vector3d PlaneProjection::Ray(double x, double y) const {
  return {(x - cx_) / fx_, (y - cy_) / fy_, 1.0};
}

Eigen::Vector2d PlaneProjection::Point(const Eigen::Vector3d& in_camera) const {
  return center_ +
         Eigen::Vector2d(axis_s_.dot(in_camera), axis_t_.dot(in_camera));
}

bool PlaneProjection::Intersect(double x, double y, Hit* hit) const {
  const Eigen::Vector3d ray = Ray(x, y);
  hit->depth = Depth(ray);
  if (!(hit->depth > 0.0)) {
    return false;
  }
  hit->point = Point(hit->depth * ray);
  // The footprint: derivatives of depth * ray by x and y on the plane.
  const double slope = normal_.dot(ray);
  const double extent_x =
      (Eigen::Vector3d::UnitX() - ray * (normal_.x() / slope)).norm();
  const double extent_y =
      (Eigen::Vector3d::UnitY() - ray * (normal_.y() / slope)).norm();
  hit->extent = {hit->depth / fx_ * extent_x, hit->depth / fy_ * extent_y};
  hit->area =
      std::pow(hit->depth, 3) / (std::abs(offset_) * std::abs(fx_ * fy_));
  return true;
}

bool PlaneProjection::Intersect(double x,
                                double y,
                                Eigen::Vector2d* point) const {
  const Eigen::Vector3d ray = Ray(x, y);
  const double depth = Depth(ray);
  *point = Point(depth * ray);
  return depth > 0.0;
}

double SignedArea(const Ring& ring) {
  double twice = 0.0;
  // Points are relative to the first, since they may be far from the origin.
  for (size_t i = 2; i < ring.size(); ++i) {
    twice += Cross(ring[i - 1] - ring[0], ring[i] - ring[0]);
  }
  return 0.5 * twice;
}

double Area(const PlanePolygon& polygon) {
  double area = SignedArea(polygon.outline);
  for (const Ring& hole : polygon.holes) {
    area += SignedArea(hole);
  }
  return area;
}

bool IsSimple(const PlanePolygon& polygon) {
  std::vector<Edge> edges;
  std::vector<size_t> sizes = {polygon.outline.size()};
  AppendEdges(polygon.outline, 0, &edges);
  for (const Ring& hole : polygon.holes) {
    AppendEdges(hole, sizes.size(), &edges);
    sizes.push_back(hole.size());
  }
  if (*std::ranges::min_element(sizes) < 3) {
    return false;
  }
  std::ranges::sort(edges, {}, &Edge::MinX);
  for (size_t i = 0; i < edges.size(); ++i) {
    const Edge& a = edges[i];
    for (size_t j = i + 1; j < edges.size() && edges[j].MinX() <= a.MaxX();
         ++j) {
      const Edge& b = edges[j];
      const size_t size = sizes[a.ring];
      const bool are_of_one = a.ring == b.ring;
      if (are_of_one && (a.index + 1) % size == b.index) {
        if (Overlap(a, b)) {
          return false;
        }
      } else if (are_of_one && (b.index + 1) % size == a.index) {
        if (Overlap(b, a)) {
          return false;
        }
      } else if (Meet(a, b)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace tsar
