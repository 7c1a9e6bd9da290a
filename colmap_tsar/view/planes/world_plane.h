// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"

#include <Eigen/Core>

namespace tsar {

// The plane normal . X + offset = 0 in the world frame, in the units of the
// sparse model. The normal has unit length; either of its two directions stands
// for the same plane, since several cameras may see it from both sides. In
// double precision for the same reason as Camera.
struct WorldPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double offset = 0.0;

  // Distance of a point from the plane, positive on the normal's side.
  double Height(const Eigen::Vector3d& point) const {
    return normal.dot(point) + offset;
  }
};

// The same plane in another frame; plane must be valid.
WorldPlane ToWorldPlane(const Plane& plane, const Camera& camera);

// Faces the camera; invalid where the plane holds the camera's centre.
Plane ToCameraPlane(const WorldPlane& plane, const Camera& camera);

}  // namespace tsar
