// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// The residuals of the joint adjustment, as Ceres differentiates them.

#include "colmap_tsar/scene/adjustment/plane_problem.h"

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

namespace tsar {

// Eigenvalues of a form below this share of its largest one are rounding
// errors.
inline constexpr double kMinRelativeValue = 1e-12;
// A plane nearer to a camera than this, in sizes of the scene, is seen edge-on.
inline constexpr double kMinRelativeHeight = 1e-12;

// A minimal parameterization of a plane by two blocks, 0 at the current plane:
// a rotation about `axes` through a point, and a shift along the normal in
// sizes of the scene. A free plane rotates about the two axes in it; a plane in
// a frame rotates with the frame, about the axes of the world.
struct MovingPlane {
  Eigen::Vector3d point;
  Eigen::Vector3d normal;
  // Axes of rotation: 2 or 3 columns.
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3> axes;
  double size;

  template <typename T>
  Eigen::Matrix<T, 3, 1> Normal(const T* turn) const {
    Eigen::Matrix<T, 3, 1> vector;
    for (int i = 0; i < 3; ++i) {
      vector[i] = T(0.0);
      for (int k = 0; k < axes.cols(); ++k) {
        vector[i] += axes(i, k) * turn[k];
      }
    }
    const Eigen::Matrix<T, 3, 1> before = normal.cast<T>();
    Eigen::Matrix<T, 3, 1> after;
    ceres::AngleAxisRotatePoint(vector.data(), before.data(), after.data());
    return after;
  }
};

// Residuals of the inverse depths that one view measured; outliers have been
// given little weight already.
class MeasurementError {
 public:
  MeasurementError(const MovingPlane& plane,
                   const PlaneMeasurement& measurement)
      : plane_(plane), center_(measurement.center) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        measurement.form.topLeftCorner<3, 3>());
    const Eigen::Vector3d mixed = measurement.form.topRightCorner<3, 1>();
    for (int i = 0; i < 3; ++i) {
      const double value = solver.eigenvalues()[i];
      if (value > kMinRelativeValue * solver.eigenvalues()[2]) {
        const double root = std::sqrt(value);
        const Eigen::Vector3d direction = solver.eigenvectors().col(i);
        root_.row(i) = root * direction.transpose();
        constant_[i] = direction.dot(mixed) / root;
      }
    }
  }

  // Returns false if the plane passes through the camera.
  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    const Eigen::Matrix<T, 3, 1> normal = plane_.Normal(blocks[0]);
    const Eigen::Matrix<T, 3, 1> arm = (center_ - plane_.point).cast<T>();
    const T height = normal.dot(arm) - plane_.size * blocks[1][0];
    if (!(ceres::abs(height) > T(kMinRelativeHeight * plane_.size))) {
      return false;
    }
    for (int i = 0; i < 3; ++i) {
      residuals[i] = (root_(i, 0) * normal.x() + root_(i, 1) * normal.y() +
                      root_(i, 2) * normal.z()) /
                         height +
                     constant_[i];
    }
    return true;
  }

 private:
  MovingPlane plane_;
  Eigen::Vector3d center_;
  // The form is |root q + constant|^2 up to a constant.
  Eigen::Matrix3d root_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d constant_ = Eigen::Vector3d::Zero();
};

// Residuals of the angle prior of two planes.
class AngleError {
 public:
  AngleError(const MovingPlane& first,
             const MovingPlane& second,
             const PlaneAnglePrior& prior)
      : planes_{first, second}, prior_(prior) {
    if (first.normal.dot(second.normal) < 0.0) {
      planes_[1].normal = -planes_[1].normal;
    }
  }

  template <typename T>
  bool operator()(T const* const* blocks, T* residuals) const {
    const Eigen::Matrix<T, 3, 1> first = planes_[0].Normal(blocks[0]);
    const Eigen::Matrix<T, 3, 1> second = planes_[1].Normal(blocks[1]);
    if (prior_.kind == PlaneAnglePrior::Kind::kOrthogonal) {
      residuals[0] = first.dot(second) / T(prior_.sigma);
      return true;
    }
    Eigen::Map<Eigen::Matrix<T, 3, 1>> difference(residuals);
    difference = (first - second) / T(prior_.sigma);
    return true;
  }

 private:
  MovingPlane planes_[2];
  PlaneAnglePrior prior_;
};

}  // namespace tsar
