// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/plane_residuals.h"

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace tsar {
namespace {

// Directions of q that a form tells less of, against what it tells most of, are
// left open: what is left of rounding.
constexpr double kMinRelativeValue = 1e-12;

// The plane as its inverse depths in a view.
struct InversePlane {
  Eigen::Vector3d q;
  Eigen::Matrix<double, 3, 4> by_coefficients;
};

// False where the plane passes through the centre.
bool InvertPlane(const Eigen::Vector4d& plane,
                 const Eigen::Vector3d& center,
                 InversePlane* inverse) {
  const double height = plane.head<3>().dot(center) + plane[3];
  if (!(std::abs(height) > std::numeric_limits<double>::min())) {
    return false;
  }
  inverse->q = plane.head<3>() / height;
  if (!inverse->q.allFinite()) {
    return false;
  }
  inverse->by_coefficients.leftCols<3>() =
      (Eigen::Matrix3d::Identity() - inverse->q * center.transpose()) / height;
  inverse->by_coefficients.col(3) = -inverse->q / height;
  return true;
}

}  // namespace

MeasurementResidual::MeasurementResidual(const PlaneMeasurement& measurement)
    : PlaneResidual(3, measurement.plane, -1, false),
      center_(measurement.center) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      measurement.form.topLeftCorner<3, 3>());
  const Eigen::Vector3d mixed = measurement.form.topRightCorner<3, 1>();
  const double min_value = kMinRelativeValue * solver.eigenvalues()[2];
  for (int i = 0; i < 3; ++i) {
    const double value = solver.eigenvalues()[i];
    if (value > min_value) {
      const double root = std::sqrt(value);
      const Eigen::Vector3d direction = solver.eigenvectors().col(i);
      root_.row(i) = root * direction.transpose();
      constant_[i] = direction.dot(mixed) / root;
    } else {
      root_.row(i).setZero();
      constant_[i] = 0.0;
    }
  }
}

bool MeasurementResidual::Evaluate(const Eigen::Vector4d* planes,
                                   Vector* residuals,
                                   Derivatives* derivatives) const {
  InversePlane inverse;
  if (!InvertPlane(planes[0], center_, &inverse)) {
    return false;
  }
  *residuals = root_ * inverse.q + constant_;
  if (derivatives != nullptr) {
    derivatives[0] = root_ * inverse.by_coefficients;
  }
  return true;
}

PointResidual::PointResidual(int plane,
                             const Eigen::Vector3d& point,
                             double sigma)
    : PlaneResidual(1, plane, -1, true), point_(point), sigma_(sigma) {}

bool PointResidual::Evaluate(const Eigen::Vector4d* planes,
                             Vector* residuals,
                             Derivatives* derivatives) const {
  const Eigen::RowVector4d row = point_.homogeneous().transpose() / sigma_;
  *residuals = row * planes[0];
  if (derivatives != nullptr) {
    derivatives[0] = row;
  }
  return true;
}

CreaseResidual::CreaseResidual(int first,
                               int second,
                               const Eigen::Vector3d& center,
                               const std::array<Eigen::Vector3d, 2>& rays,
                               double sigma)
    : PlaneResidual(2, first, second, true), center_(center), sigma_(sigma) {
  rays_ << rays[0].transpose(), rays[1].transpose();
}

bool CreaseResidual::Evaluate(const Eigen::Vector4d* planes,
                              Vector* residuals,
                              Derivatives* derivatives) const {
  InversePlane first;
  InversePlane second;
  if (!InvertPlane(planes[0], center_, &first) ||
      !InvertPlane(planes[1], center_, &second)) {
    return false;
  }
  *residuals = rays_ * (first.q - second.q) / sigma_;
  if (derivatives != nullptr) {
    derivatives[0] = rays_ * first.by_coefficients / sigma_;
    derivatives[1] = -rays_ * second.by_coefficients / sigma_;
  }
  return true;
}

ParallelResidual::ParallelResidual(int first,
                                   int second,
                                   double sign,
                                   double sigma)
    : PlaneResidual(3, first, second, true), sign_(sign), sigma_(sigma) {}

bool ParallelResidual::Evaluate(const Eigen::Vector4d* planes,
                                Vector* residuals,
                                Derivatives* derivatives) const {
  *residuals = (planes[0].head<3>() - sign_ * planes[1].head<3>()) / sigma_;
  if (derivatives != nullptr) {
    derivatives[0] = Eigen::Matrix<double, 3, 4>::Identity() / sigma_;
    derivatives[1] = -sign_ * derivatives[0];
  }
  return true;
}

OrthogonalResidual::OrthogonalResidual(int first, int second, double sigma)
    : PlaneResidual(1, first, second, true), sigma_(sigma) {}

bool OrthogonalResidual::Evaluate(const Eigen::Vector4d* planes,
                                  Vector* residuals,
                                  Derivatives* derivatives) const {
  const Eigen::Vector3d first = planes[0].head<3>();
  const Eigen::Vector3d second = planes[1].head<3>();
  residuals->resize(1);
  (*residuals)[0] = first.dot(second) / sigma_;
  if (derivatives != nullptr) {
    derivatives[0].setZero(1, 4);
    derivatives[1].setZero(1, 4);
    derivatives[0].leftCols<3>() = second.transpose() / sigma_;
    derivatives[1].leftCols<3>() = first.transpose() / sigma_;
  }
  return true;
}

}  // namespace tsar
