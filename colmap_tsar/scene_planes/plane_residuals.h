// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/plane_measurement.h"

#include <array>

#include <Eigen/Core>

namespace tsar {

// What something tells of one or two planes: how far their coefficients
// (normal, offset) contradict it, in expected errors.
class PlaneResidual {
 public:
  static constexpr int kMaxSize = 3;
  using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxSize, 1>;
  // By the coefficients of one plane.
  using Derivatives = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, kMaxSize, 4>;

  // second: -1 where it is of one plane. is_robust: whether it may be an
  // outlier, and counts with Cauchy's loss.
  PlaneResidual(int size, int first, int second, bool is_robust)
      : size_(size), planes_{first, second}, is_robust_(is_robust) {}
  virtual ~PlaneResidual() = default;

  int Size() const { return size_; }
  int NumPlanes() const { return planes_[1] < 0 ? 1 : 2; }
  int PlaneAt(int number) const { return planes_[number]; }
  bool IsRobust() const { return is_robust_; }

  // Coefficients of each plane; the residuals; their derivatives for each
  // plane, or null. False where planes pass through a camera.
  virtual bool Evaluate(const Eigen::Vector4d* planes,
                        Vector* residuals,
                        Derivatives* derivatives) const = 0;

 private:
  int size_;
  std::array<int, 2> planes_;
  bool is_robust_;
};

// The inverse depths that one view measured. Robust already.
class MeasurementResidual : public PlaneResidual {
 public:
  explicit MeasurementResidual(const PlaneMeasurement& measurement);
  bool Evaluate(const Eigen::Vector4d* planes,
                Vector* residuals,
                Derivatives* derivatives) const override;

 private:
  Eigen::Vector3d center_;
  // The form is |root q + constant|^2 up to what no q changes.
  Eigen::Matrix3d root_;
  Eigen::Vector3d constant_;
};

// A point lies on the plane, within sigma.
class PointResidual : public PlaneResidual {
 public:
  PointResidual(int plane, const Eigen::Vector3d& point, double sigma);
  bool Evaluate(const Eigen::Vector4d* planes,
                Vector* residuals,
                Derivatives* derivatives) const override;

 private:
  Eigen::Vector3d point_;
  double sigma_;
};

// Two planes have one inverse depth along two rays of a view. sigma: of an
// inverse depth.
class CreaseResidual : public PlaneResidual {
 public:
  CreaseResidual(int first,
                 int second,
                 const Eigen::Vector3d& center,
                 const std::array<Eigen::Vector3d, 2>& rays,
                 double sigma);
  bool Evaluate(const Eigen::Vector4d* planes,
                Vector* residuals,
                Derivatives* derivatives) const override;

 private:
  Eigen::Vector3d center_;
  Eigen::Matrix<double, 2, 3> rays_;
  double sigma_;
};

// Two planes are parallel. sign: of the second normal against the first's.
class ParallelResidual : public PlaneResidual {
 public:
  ParallelResidual(int first, int second, double sign, double sigma);
  bool Evaluate(const Eigen::Vector4d* planes,
                Vector* residuals,
                Derivatives* derivatives) const override;

 private:
  double sign_;
  double sigma_;
};

// Two planes are orthogonal.
class OrthogonalResidual : public PlaneResidual {
 public:
  OrthogonalResidual(int first, int second, double sigma);
  bool Evaluate(const Eigen::Vector4d* planes,
                Vector* residuals,
                Derivatives* derivatives) const override;

 private:
  double sigma_;
};

}  // namespace tsar
