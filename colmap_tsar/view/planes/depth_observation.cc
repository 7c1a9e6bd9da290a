// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/depth_observation.h"

#include <algorithm>
#include <cmath>

namespace tsar {

double RaySlope(const WorldPlane& plane, const DepthObservation& observation) {
  constexpr double kMinSlope = 0.05;
  return std::max(std::abs(plane.normal.dot(observation.ray)),
                  kMinSlope * observation.ray.norm());
}

double NormalizedResidual(const WorldPlane& plane,
                          const DepthObservation& observation) {
  return plane.Height(observation.Point()) /
         (RaySlope(plane, observation) * observation.sigma);
}

Eigen::Vector3d FootPoint(const WorldPlane& plane,
                          const DepthObservation& observation) {
  const Eigen::Vector3d point = observation.Point();
  const double step = plane.Height(point) / RaySlope(plane, observation);
  const bool along_normal = plane.normal.dot(observation.ray) > 0.0;
  return point + (along_normal ? -step : step) * observation.ray;
}

}  // namespace tsar
