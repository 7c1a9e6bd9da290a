// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <ceres/ceres.h>
#include <ceres/normal_prior.h>

namespace tsar {
namespace {

// Angles are in radians, lengths in sizes of the scene.
constexpr int kMaxRounds = 3;
// Parameters that change by less have converged.
constexpr double kConvergence = 1e-9;
// Inverse standard deviation of the prior that keeps what nothing determines:
// too weak to affect known parameters.
constexpr double kPriorWeight = 1.0 / 32.0;
// Variances above this are infinite: without evidence they are far larger.
constexpr double kUnknownVariance = 0.25;
// Eigenvalues of a form below this share of its largest one are rounding
// errors, and cameras nearer than this to a plane see it edge-on.
constexpr double kRounding = 1e-12;
// Planes within 3 degrees (its sine) of being parallel or orthogonal are so
// with a standard deviation of 0.5 degrees.
constexpr double kSinMaxAngle = 0.0523;
constexpr double kSigmaOfAngle = 0.00873;
// The largest number of planes that a plane is tied to, and of planes of its
// component that are tried.
constexpr int kMaxPartners = 3;
constexpr size_t kMaxTried = 30;

template <typename T>
Eigen::Vector3<T> Turn(const T* quaternion, const Eigen::Vector3d& vector) {
  return Eigen::Map<const Eigen::Quaternion<T>>(quaternion) * vector.cast<T>();
}

// Residuals of the inverse depths that one view measured, by the turn of the
// plane and its height below a point.
struct MeasurementError {
  Eigen::Vector3d normal;  // Before the turn.
  Eigen::Vector3d arm;     // From the point to the camera.
  // The measurement's form is |root q + constant|^2 up to a constant.
  Eigen::Matrix3d root = Eigen::Matrix3d::Zero();
  Eigen::Vector3d constant = Eigen::Vector3d::Zero();

  MeasurementError(const Eigen::Vector3d& normal,
                   const Eigen::Vector3d& arm,
                   const PlaneMeasurement& measurement,
                   double size)
      : normal(normal), arm(arm) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
        measurement.form.topLeftCorner<3, 3>());
    for (int i = 0; i < 3; ++i) {
      const double value = solver.eigenvalues()[i];
      if (value > kRounding * solver.eigenvalues()[2]) {
        const Eigen::Vector3d direction = solver.eigenvectors().col(i);
        root.row(i) = std::sqrt(value) / size * direction.transpose();
        constant[i] = direction.dot(measurement.form.topRightCorner<3, 1>()) /
                      std::sqrt(value);
      }
    }
  }

  // Returns false if the plane passes through the camera.
  template <typename T>
  bool operator()(const T* turn, const T* height, T* residuals) const {
    const Eigen::Vector3<T> turned = Turn(turn, normal);
    const T above = turned.dot(arm.cast<T>()) + *height;
    Eigen::Map<Eigen::Vector3<T>> errors(residuals);
    errors = root.cast<T>() * turned / above + constant.cast<T>();
    return ceres::abs(above) > T(kRounding);
  }
};

// Residuals of two planes that are parallel or orthogonal.
struct AngleError {
  Eigen::Vector3d first;  // Normals before the turns.
  Eigen::Vector3d second;
  bool are_parallel;

  template <typename T>
  bool operator()(const T* turn, const T* other_turn, T* residuals) const {
    const Eigen::Vector3<T> a = Turn(turn, first);
    const Eigen::Vector3<T> b = Turn(other_turn, second);
    Eigen::Map<Eigen::Vector3<T>> errors(residuals);
    errors.setZero();
    if (are_parallel) {
      errors = a.cross(b) / T(kSigmaOfAngle);
    } else {
      errors.x() = a.dot(b) / T(kSigmaOfAngle);
    }
    return true;
  }
};

// The median distance of cameras from what they measured.
double SizeOf(const std::vector<PlaneMeasurement>& measurements) {
  std::vector<double> distances;
  for (const PlaneMeasurement& measurement : measurements) {
    if (measurement.information > 0.0) {
      distances.push_back((measurement.foot - measurement.center).norm());
    }
  }
  const double size = distances.empty() ? 0.0 : UpperMedian(&distances);
  return size > 0.0 ? size : 1.0;
}

// One adjustment of the planes of a model to measurements at their places. The
// parameters are the turn of each frame and of each plane in none, and the
// height of each plane.
class PlaneProblem {
 public:
  PlaneProblem(const std::vector<PlaneMeasurement>& measurements,
               const SceneModel& model)
      : size_(SizeOf(measurements)), planes_(model.planes.size()) {
    AddPlanes(measurements, model);
    for (const PlaneMeasurement& measurement : measurements) {
      MovingPlane& plane = planes_[measurement.plane];
      const Eigen::Vector3d arm = (measurement.center - plane.middle) / size_;
      if (measurement.information > 0.0 &&
          std::abs(plane.normal.dot(arm) + *plane.height) > 2.0 * kRounding) {
        problem_.AddResidualBlock(
            new ceres::AutoDiffCostFunction<MeasurementError, 3, 4, 1>(
                new MeasurementError(plane.normal, arm, measurement, size_)),
            nullptr,
            plane.turn,
            plane.height);
      }
    }
    AddAngles(model.planes);
  }

  // Moves the planes and frames of the model. Returns whether any moved.
  bool Solve(SceneModel* model) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    // The only sparse library whose sums do not depend on the machine.
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.num_threads = 1;
    // Planes are measured and adjusted again, so few iterations suffice.
    options.max_num_iterations = 10;
    options.function_tolerance = 1e-7;
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable()) {
      return false;
    }
    bool moves = false;
    for (size_t f = 0; f < model->frames.size(); ++f) {
      const Eigen::Map<const Eigen::Quaterniond> turn(&parameters_[4 * f]);
      model->frames[f] =
          (turn * Eigen::Quaterniond(model->frames[f])).toRotationMatrix();
    }
    for (size_t p = 0; p < planes_.size(); ++p) {
      const MovingPlane& plane = planes_[p];
      ModelPlane& moved = model->planes[p];
      Eigen::Vector3d normal = Turn(plane.turn, plane.normal).normalized();
      if (moved.frame >= 0) {
        const Eigen::Vector3d axis = model->frames[moved.frame].col(moved.axis);
        normal = axis.dot(normal) < 0.0 ? Eigen::Vector3d(-axis) : axis;
      }
      moves = moves || moved.plane.normal.cross(normal).norm() > kConvergence ||
              std::abs(moved.plane.Height(plane.middle) / size_ -
                       *plane.height) > kConvergence;
      moved.plane = {normal, size_ * *plane.height - normal.dot(plane.middle)};
    }
    return moves;
  }

  // Sets centers, axes and covariances of the model's planes: those of the
  // inverse of the information matrix, which is found in a small part of the
  // time of ceres::Covariance, since there are many more rows than columns.
  void Describe(SceneModel* model) {
    using Matrix = Eigen::SparseMatrix<double>;
    ceres::CRSMatrix rows;
    Eigen::SimplicialLDLT<Matrix> information;
    bool is_known = problem_.Evaluate({}, nullptr, nullptr, nullptr, &rows);
    if (is_known && rows.num_rows > 0) {
      const Matrix derivatives =
          Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
              rows.num_rows,
              rows.num_cols,
              rows.values.size(),
              rows.rows.data(),
              rows.cols.data(),
              rows.values.data());
      information.compute(derivatives.transpose() * derivatives);
      is_known = information.info() == Eigen::Success;
    }
    for (size_t p = 0; p < planes_.size(); ++p) {
      const MovingPlane& plane = planes_[p];
      const int turn = columns_.at(plane.turn);
      const Eigen::Vector4i columns(
          turn, turn + 1, turn + 2, columns_.at(plane.height));
      Eigen::Matrix4d all =
          4.0 * kUnknownVariance * Eigen::Matrix4d::Identity();
      // Steps of a quaternion are half of the turn; a plane that moves along
      // its normal is less high above the point.
      const Eigen::Vector4d units(2.0, 2.0, 2.0, -1.0);
      for (int i = 0; is_known && i < 4; ++i) {
        const Eigen::VectorXd column =
            information.solve(Eigen::VectorXd::Unit(rows.num_cols, columns[i]));
        all.col(i) = units[i] * units.cwiseProduct(column(columns));
      }
      Describe(all, plane.middle, &model->planes[p]);
    }
  }

 private:
  struct MovingPlane {
    Eigen::Vector3d normal;  // Before the turn.
    // Near the center of its measurements, so that the errors of turn and shift
    // are nearly independent; on the plane or off it.
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double weight = 0.0;
    double* turn = nullptr;    // A quaternion.
    double* height = nullptr;  // Of the middle above the plane.
  };

  void AddPlanes(const std::vector<PlaneMeasurement>& measurements,
                 const SceneModel& model) {
    for (const PlaneMeasurement& measurement : measurements) {
      MovingPlane& plane = planes_[measurement.plane];
      plane.middle += measurement.information * measurement.foot;
      plane.weight += measurement.information;
    }
    const size_t num_frames = model.frames.size();
    const size_t num_turns = num_frames + planes_.size();
    parameters_.resize(4 * num_turns + planes_.size());
    for (size_t p = 0; p < planes_.size(); ++p) {
      const ModelPlane& from = model.planes[p];
      MovingPlane& plane = planes_[p];
      plane.normal = from.plane.normal;
      size_t turn = num_frames + p;
      if (from.frame >= 0) {
        const Eigen::Vector3d axis = model.frames[from.frame].col(from.axis);
        plane.normal =
            axis.dot(plane.normal) < 0.0 ? Eigen::Vector3d(-axis) : axis;
        turn = from.frame;
      }
      plane.middle = plane.weight > 0.0
                         ? Eigen::Vector3d(plane.middle / plane.weight)
                         : from.center;
      plane.height = &parameters_[4 * num_turns + p];
      *plane.height = from.plane.Height(plane.middle) / size_;
      plane.turn = &parameters_[4 * turn];
      if (!problem_.HasParameterBlock(plane.turn)) {
        const Eigen::Quaterniond identity = Eigen::Quaterniond::Identity();
        std::ranges::copy(identity.coeffs(), plane.turn);
        ceres::Matrix weights = ceres::Matrix::Zero(3, 4);
        weights.leftCols<3>().diagonal().setConstant(2.0 * kPriorWeight);
        AddPrior(weights, identity.coeffs(), plane.turn);
        problem_.SetManifold(plane.turn, new ceres::EigenQuaternionManifold);
      }
      AddPrior(ceres::Matrix::Constant(1, 1, kPriorWeight),
               ceres::Vector::Constant(1, *plane.height),
               plane.height);
    }
  }

  void AddPrior(const ceres::Matrix& weights,
                const ceres::Vector& mean,
                double* block) {
    problem_.AddResidualBlock(
        new ceres::NormalPrior(weights, mean), nullptr, block);
    columns_[block] = num_columns_;
    num_columns_ += static_cast<int>(weights.rows());
  }

  // Ties each plane that lies in no frame to few others, so that time is linear
  // in their number.
  void AddAngles(const std::vector<ModelPlane>& planes) {
    std::map<int, std::vector<size_t>> tried;  // By component.
    for (size_t p = 0; p < planes.size(); ++p) {
      std::vector<size_t>& before = tried[planes[p].component];
      int num_partners = 0;
      for (const size_t other : before) {
        const Eigen::Vector3d& a = planes_[other].normal;
        const Eigen::Vector3d& b = planes_[p].normal;
        const bool are_parallel = a.cross(b).norm() < kSinMaxAngle;
        if (planes[p].frame < 0 && num_partners < kMaxPartners &&
            (are_parallel || std::abs(a.dot(b)) < kSinMaxAngle)) {
          problem_.AddResidualBlock(
              new ceres::AutoDiffCostFunction<AngleError, 3, 4, 4>(
                  new AngleError{a, b, are_parallel}),
              new ceres::CauchyLoss(1.0),
              planes_[other].turn,
              planes_[p].turn);
          ++num_partners;
        }
      }
      if (before.size() < kMaxTried) {
        before.push_back(p);
      }
    }
  }

  // all: covariance of the turn about the axes of the world and of the shift.
  void Describe(const Eigen::Matrix4d& all,
                const Eigen::Vector3d& middle,
                ModelPlane* plane) const {
    const Eigen::Vector3d normal = plane->plane.normal;
    Eigen::Matrix<double, 3, 2> along;
    along.col(0) = normal.unitOrthogonal();
    along.col(1) = normal.cross(along.col(0));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
        along.transpose() * all.topLeftCorner<3, 3>() * along);
    const Eigen::Vector3d axis_s = along * solver.eigenvectors().col(0);
    const Eigen::Vector3d axis_t = normal.cross(axis_s);
    Eigen::Matrix<double, 3, 4> axes = Eigen::Matrix<double, 3, 4>::Zero();
    axes.row(0).head<3>() = axis_s;
    axes.row(1).head<3>() = axis_t;
    axes(2, 3) = 1.0;
    const Eigen::Matrix3d principal = axes * all * axes.transpose();
    const Eigen::Vector3d units(1.0, 1.0, size_);
    plane->covariance = units.asDiagonal() * principal * units.asDiagonal();
    for (int i = 0; i < 3; ++i) {
      if (!(principal(i, i) < kUnknownVariance)) {
        plane->covariance.row(i).setZero();
        plane->covariance.col(i).setZero();
        plane->covariance(i, i) = std::numeric_limits<double>::infinity();
      }
    }
    if (std::isfinite(plane->covariance(2, 2))) {
      plane->center = middle - plane->plane.Height(middle) * normal;
      plane->axis_s = axis_s;
      plane->axis_t = axis_t;
    }
  }

  double size_;
  std::vector<MovingPlane> planes_;
  // The turns of the frames, those of the planes, and the heights: in one
  // array, since the order of sums is that of addresses.
  std::vector<double> parameters_;
  // The first column of each of them in the derivatives.
  std::map<const double*, int> columns_;
  int num_columns_ = 0;
  ceres::Problem problem_;
};

}  // namespace

void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model) {
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (!may_move[p] && plane.frame >= 0) {
      const Eigen::Vector3d axis = model->frames[plane.frame].col(plane.axis);
      // Up to rounding.
      if (!(axis.cross(plane.plane.normal).norm() < 1e-9)) {
        plane.frame = plane.axis = -1;
      }
    }
  }
  SceneModel adjusted = *model;
  bool moves = std::ranges::find(may_move, true) != may_move.end();
  for (int round = 0; moves && round < kMaxRounds; ++round) {
    moves = PlaneProblem(measure(adjusted.planes), adjusted).Solve(&adjusted);
  }
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (may_move[p] && plane.frame >= 0) {
      model->frames[plane.frame] = adjusted.frames[plane.frame];
    }
    if (may_move[p]) {
      plane.plane = adjusted.planes[p].plane;
    }
  }
  PlaneProblem(measure(model->planes), *model).Describe(model);
}

}  // namespace tsar
