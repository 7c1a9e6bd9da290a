// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"

#include <Eigen/Core>

namespace tsar {

// The plane normal . X + offset = 0 in the world frame, in the units of the
// sparse model. The normal has unit length; either of its two directions stands
// for the same plane, since several cameras may see it from both sides. Double
// precision for the same reason as Camera.
struct WorldPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;

  // Distance of a point from the plane, positive on the normal's side.
  double Height(const Eigen::Vector3d& point) const {
    return normal.dot(point) + offset;
  }
};

// Transforms a plane, which must be valid, from the camera to the world frame.
WorldPlane ToWorldPlane(const Plane& plane, const Camera& camera);

// Transforms a plane to the camera frame. The result faces the camera; it is
// invalid if the plane holds the camera's center.
Plane ToCameraPlane(const WorldPlane& plane, const Camera& camera);

}  // namespace tsar
