// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"

#include <limits>
#include <vector>

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
// Never below the slope of a ray at 3 degrees to the plane: flatter ones
// intersect it far from the measured point, or never.
double RaySlope(const WorldPlane& plane, const DepthObservation& observation);

// The residual of the depth along the ray, in its expected errors.
double NormalizedResidual(const WorldPlane& plane,
                          const DepthObservation& observation);

// The intersection of the ray and the plane. It does not depend on the depth,
// so an error of the depth does not move it along the plane, except for nearly
// grazing rays.
Eigen::Vector3d FootPoint(const WorldPlane& plane,
                          const DepthObservation& observation);

// The uncertainty of a plane fitted to observations, propagated from their
// expected errors. It grows with the distance from them.
struct PlaneUncertainty {
  // The center of the support, where the variance is least.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  // The unit directions along the plane in which the support is longest and
  // shortest; the errors of the three estimates are independent of each other.
  Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Zero();
  // Variance at the center; infinite without observations.
  double height_variance = std::numeric_limits<double>::infinity();
  // Variances of the slope along each axis; infinite where no two
  // observations lie apart in that direction.
  Eigen::Vector2d slope_variance =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  // Points within this distance of the center along an axis of infinite
  // variance are treated as at the center.
  double position_tolerance = 0.0;

  // Standard deviation of the plane's height, along its normal, at a point on
  // it; infinite where the observations leave it undetermined.
  double Sigma(const Eigen::Vector3d& point) const;
};

// First-order propagation of independent, normally distributed errors. Errors
// of neighboring pixels are correlated, so callers pass one observation for all
// of them. An observation of weight w counts w times. All must be inliers of
// the plane.
//
// This is the uncertainty of least squares. The standard deviation at the
// minimum of FitPlane's Cauchy loss, which is less efficient, is larger: 1.37
// times with a loss_scale of 0.5.
PlaneUncertainty ComputeUncertainty(
    const WorldPlane& plane, const std::vector<DepthObservation>& observations);

}  // namespace tsar
