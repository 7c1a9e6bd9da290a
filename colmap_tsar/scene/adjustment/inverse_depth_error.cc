// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// Prior standard deviations of parameters that nothing determines.
constexpr double kPriorTurn = 0.02;   // In radians.
constexpr double kPriorShift = 0.01;  // Relative to camera distance.
// Stands for an infinite variance, in units of the prior variances.
constexpr double kHugeVariance = 1e12;

// The plane's covariance C combined with the prior P: the inverse of C^-1 +
// P^-1.
Eigen::Matrix3d BoundedCovariance(const ModelPlane& plane, double distance) {
  const Eigen::Vector3d prior(kPriorTurn, kPriorTurn, kPriorShift * distance);
  const Eigen::Matrix3d units = prior * prior.transpose();
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  // In units of the prior, the inverse of C^-1 + I is I - (C + I)^-1, which
  // needs no inverse of C. Where a variance is infinite, there are no
  // correlations.
  Eigen::Matrix3d covariance = plane.covariance.cwiseQuotient(units);
  covariance.diagonal() = covariance.diagonal().cwiseMin(kHugeVariance);
  const Eigen::Matrix3d bounded =
      identity - (covariance + identity).ldlt().solve(identity);
  return bounded.cwiseProduct(units);
}

}  // namespace

InverseDepthError ErrorInView(const ModelPlane& plane, const Camera& camera) {
  const Eigen::Vector3d& normal = plane.plane.normal;
  const Eigen::Vector3d center = camera.Center();
  const double height = plane.plane.Height(center);
  if (!(std::abs(height) > 0.0)) {
    return {};
  }
  // Derivatives of normal / height by the two rotations about the plane's
  // center and the shift along its normal.
  Eigen::Matrix3d derivatives;
  const Eigen::Vector3d arm = center - plane.center;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d turned =
        (i == 0 ? plane.axis_s : plane.axis_t).cross(normal);
    derivatives.col(i) =
        turned / height - normal * (turned.dot(arm) / (height * height));
  }
  derivatives.col(2) = normal / (height * height);
  const Eigen::Matrix3d in_view = camera.rotation * derivatives;
  const Eigen::Matrix3d error = in_view *
                                BoundedCovariance(plane, std::abs(height)) *
                                in_view.transpose();
  const auto at = [&](int i, int j) { return static_cast<float>(error(i, j)); };
  return {at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2)};
}

}  // namespace tsar
