// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/world_plane.h"

#include <Eigen/Core>

namespace tsar {

// A depth that one view measured, in the world frame: the point lies at center
// + depth * ray.
struct DepthObservation {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // Of the camera.
  // Has z = 1 in the camera's frame, so that depth is z there.
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double depth = 0.0;
  double sigma = 1.0;   // Expected error of the depth, in its units; above 0.
  double weight = 1.0;  // How many observations it counts for; not below 0.
  // Deviations up to this many tolerances count as none.
  double slack = 0.0;

  Eigen::Vector3d Point() const { return center + depth * ray; }
};

// By how much the ray's height over the plane changes per unit of depth,
// without its sign. Never below the slope of a ray at 3 degrees to the plane:
// flatter ones cross it far from what they measured, or never.
double RaySlope(const WorldPlane& plane, const DepthObservation& observation);

// How far the depth lies behind or before the plane, in its expected errors.
double NormalizedResidual(const WorldPlane& plane,
                          const DepthObservation& observation);

// Where the ray meets the plane. It does not depend on the depth, so an error
// of the depth does not move it along the plane; near to grazing rays it does.
Eigen::Vector3d FootPoint(const WorldPlane& plane,
                          const DepthObservation& observation);

}  // namespace tsar
