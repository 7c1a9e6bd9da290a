// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/world_plane.h"

#include <Eigen/Core>

namespace tsar {

// A depth that one view measured, in the world frame: the point lies at center
// + depth * ray.
struct DepthObservation {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // The camera center.
  // The ray has z = 1 in the camera's frame, so that depth is z there.
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();
  double depth = 0.0;
  double sigma = 1.0;   // Expected error of the depth, in its units; above 0.
  double weight = 1.0;  // The number of observations it counts for; >= 0.
  // Deviations up to this many tolerances count as 0.
  double slack = 0.0;

  Eigen::Vector3d Point() const { return center + depth * ray; }
};

// The absolute change of the ray's height over the plane per unit of depth.
// Never below the slope of a ray at 3 degrees to the plane: flatter ones cross
// it far from what they measured, or never.
double RaySlope(const WorldPlane& plane, const DepthObservation& observation);

// The residual of the depth along the ray, in its expected errors.
double NormalizedResidual(const WorldPlane& plane,
                          const DepthObservation& observation);

// The intersection of the ray and the plane. It does not depend on the depth,
// so an error of the depth does not move it along the plane, except for nearly
// grazing rays.
Eigen::Vector3d FootPoint(const WorldPlane& plane,
                          const DepthObservation& observation);

}  // namespace tsar
