// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

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
                                 const Camera& camera) {
  Eigen::Matrix3d image_from_camera;
  image_from_camera << camera.fx, 0.0, camera.cx,  //
      0.0, camera.fy, camera.cy,                   //
      0.0, 0.0, 1.0;
  Eigen::Matrix3d world_from_plane;
  world_from_plane << coordinates.axis_s, coordinates.axis_t,
      coordinates.origin - camera.Center();
  plane_from_image_ =
      (image_from_camera * camera.rotation * world_from_plane).inverse();
}

bool PlaneProjection::Intersect(double x, double y, Hit* hit) const {
  const Eigen::Vector3d at = plane_from_image_ * Eigen::Vector3d(x, y, 1.0);
  hit->depth = 1.0 / at.z();
  // A camera in the plane gives NaN.
  if (!(hit->depth > 0.0) || !std::isfinite(hit->depth)) {
    return false;
  }
  hit->point = hit->depth * at.head<2>();
  // The derivatives of the point by x and y.
  const Eigen::Matrix2d derivatives =
      hit->depth * (plane_from_image_.topLeftCorner<2, 2>() -
                    hit->point * plane_from_image_.bottomLeftCorner<1, 2>());
  hit->extent = derivatives.colwise().norm();
  hit->area = std::abs(derivatives.determinant());
  return true;
}

std::vector<PlaneProjection> ProjectionsOf(
    const std::vector<PlaneCoordinates>& planes, const Camera& camera) {
  std::vector<PlaneProjection> projections;
  for (const PlaneCoordinates& coordinates : planes) {
    projections.emplace_back(coordinates, camera);
  }
  return projections;
}

}  // namespace tsar
