// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_coordinates.h"

#include <cmath>

#include <Eigen/Geometry>

namespace tsar {

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
  // From the derivatives of depth * ray by x and by y, along which the point
  // stays on the plane.
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

}  // namespace tsar
