// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/planes/depth_observation.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <limits>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// How far a plane that was fitted to observations may lie beside the true one,
// as the observations' expected errors tell. It grows with the distance from
// them.
struct PlaneUncertainty {
  // The middle of the support, where the plane is known best.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  // The unit directions along the plane in which the support is longest and
  // shortest; the errors of the three estimates are independent of each other.
  Eigen::Matrix<double, 3, 2> axes = Eigen::Matrix<double, 3, 2>::Zero();
  // Variance at the centre; infinite without observations.
  double height_variance = std::numeric_limits<double>::infinity();
  // Variances of the slope along each axis; infinite where no two
  // observations lie apart in that direction.
  Eigen::Vector2d slope_variance =
      Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  // Within this distance of the centre along an axis of infinite variance,
  // points count as being at the centre.
  double position_tolerance = 0.0;

  // Standard deviation of the plane's height, along its normal, at a point on
  // it; infinite where the observations leave it undetermined.
  double Sigma(const Eigen::Vector3d& point) const;
};

// To first order, with errors that are independent of each other and normally
// distributed: neighbouring pixels err together, so callers pass one
// observation for all of them. An observation of weight w counts for w of them.
// All must be of the plane; outliers have to be left out.
//
// It is what least squares attains. Planes at the minimum of FitPlane's loss
// spread more widely, since it uses less of what each observation tells: 1.37
// times as widely with a loss_scale of 0.5.
PlaneUncertainty ComputeUncertainty(
    const WorldPlane& plane, const std::vector<DepthObservation>& observations);

}  // namespace tsar
