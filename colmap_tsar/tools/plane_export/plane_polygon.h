// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// Right-handed coordinates (s, t) in a plane, in the units of the world.
struct PlaneCoordinates {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_s = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_t = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();

  Eigen::Vector2d ToPlane(const Eigen::Vector3d& point) const {
    return {axis_s.dot(point - origin), axis_t.dot(point - origin)};
  }
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& point) const {
    return origin + point.x() * axis_s + point.y() * axis_t;
  }
};

// The plane's normal and first axis, and the point of it nearest to its center.
PlaneCoordinates CoordinatesOf(const ModelPlane& plane);

// The intersections of a view's pixels with a plane.
class PlaneProjection {
 public:
  PlaneProjection(const PlaneCoordinates& coordinates, const Camera& camera);

  struct Hit {
    double depth = 0.0;     // > 0
    Eigen::Vector2d point;  // In plane coordinates.
    // The footprint of the pixel on the plane: area, width and height.
    double area = 0.0;
    Eigen::Vector2d extent;
  };

  // Returns false if the pixel does not see the plane.
  bool Intersect(double x, double y, Hit* hit) const;

 private:
  // From homogeneous pixels to homogeneous points of the plane, over depth.
  Eigen::Matrix3d plane_from_image_;
};

// Those of planes into a view.
std::vector<PlaneProjection> ProjectionsOf(
    const std::vector<PlaneCoordinates>& planes, const Camera& camera);

// A closed line; its last point is joined to its first one.
using Ring = std::vector<Eigen::Vector2d>;

// A part of a plane, in the plane's coordinates. The outline runs
// counterclockwise, the holes clockwise.
struct PlanePolygon {
  Ring outline;
  std::vector<Ring> holes;
  double area = 0.0;  // Without the holes.
};

// The z component of the cross product, positive if b is left of a.
inline double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace tsar
