// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/depth_observation.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace tsar {

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
