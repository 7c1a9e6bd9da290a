// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/plane_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#include <ceres/rotation.h>

namespace tsar {
namespace {

// Convergence threshold of parameters: radians, and sizes of the scene.
constexpr double kConvergence = 1e-9;
// Inverse standard deviation of the prior, in these units: too weak to affect
// known parameters.
constexpr double kPriorWeight = 1.0 / 32.0;
// Variances above this, in these units, are infinite: without evidence they are
// far larger.
constexpr double kUnknownVariance = 0.25;
// Eigenvalues of a form below this share of its largest one are rounding
// errors.
constexpr double kMinRelativeValue = 1e-12;
// A plane nearer to a camera than this, in sizes of the scene, is seen edge-on.
constexpr double kMinRelativeHeight = 1e-12;

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

// Residuals of the angle prior of two planes, in standard deviations.
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
    } else {
      Eigen::Map<Eigen::Matrix<T, 3, 1>> difference(residuals);
      difference = (first - second) / T(prior_.sigma);
    }
    return true;
  }

 private:
  MovingPlane planes_[2];
  PlaneAnglePrior prior_;
};

// The problem in Ceres. The parameter vector, initially 0, has the rotation of
// each frame, the rotation of each free plane and the shift of each plane.
class CeresProblem {
 public:
  explicit CeresProblem(const PlaneProblem& problem) : size_(problem.size) {
    AddPlanes(problem);
    for (const PlaneMeasurement& measurement : problem.measurements) {
      const int p = measurement.plane;
      const double height = problem.at.planes[p].Height(measurement.center);
      if (measurement.information > 0.0 &&
          std::abs(height) > 2.0 * kMinRelativeHeight * size_) {
        AddResidual(new MeasurementError(planes_[p], measurement),
                    3,
                    nullptr,
                    {turns_[p], shifts_[p]});
      }
    }
    for (const PlaneAnglePrior& angle : problem.at.angles) {
      const int first = angle.first;
      const int second = angle.second;
      // The angle of two planes of one frame is constant.
      if (turns_[first] != turns_[second]) {
        AddResidual(new AngleError(planes_[first], planes_[second], angle),
                    angle.kind == PlaneAnglePrior::Kind::kParallel ? 3 : 1,
                    new ceres::CauchyLoss(1.0),
                    {turns_[first], turns_[second]});
      }
    }
  }

  bool Solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    // The only sparse library of Ceres whose sums do not depend on the machine.
    if (ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE)) {
      options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    }
    options.num_threads = 1;
    // Planes are measured and adjusted again, so few iterations suffice.
    options.max_num_iterations = 10;
    options.function_tolerance = 1e-7;
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-9;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_, &summary);
    if (!summary.IsSolutionUsable()) {
      std::fill(parameters_.begin(), parameters_.end(), 0.0);
    }
    return std::ranges::any_of(parameters_, [](double parameter) {
      return std::abs(parameter) >= kConvergence;
    });
  }

  // Applies the parameters to planes and frames.
  void Move(PlaneAdjustment* at) const {
    for (size_t f = 0; f < at->frames.size(); ++f) {
      const Eigen::Map<const Eigen::Vector3d> turn(&parameters_[3 * f]);
      if (!turn.isZero(0.0)) {
        at->frames[f] = Eigen::Quaterniond(
                            Eigen::AngleAxisd(turn.norm(), turn.normalized()) *
                            at->frames[f])
                            .normalized()
                            .toRotationMatrix();
      }
    }
    for (size_t p = 0; p < planes_.size(); ++p) {
      const MovingPlane& plane = planes_[p];
      Eigen::Vector3d normal = plane.Normal(turns_[p]).normalized();
      if (IsInFrame(*at, p)) {
        const Eigen::Vector3d column = ColumnOf(*at, p);
        normal = column.dot(normal) < 0.0 ? -column : column;
      }
      at->planes[p] = {normal,
                       -normal.dot(plane.point) - plane.size * *shifts_[p]};
    }
  }

  // The covariance of rotation and shift for each plane; huge where
  // undetermined. It inverts the information matrix in a tenth of the time of
  // ceres::Covariance's QR decomposition.
  std::vector<Eigen::MatrixXd> Covariances() {
    using Matrix = Eigen::SparseMatrix<double>;
    ceres::Problem::EvaluateOptions options;
    options.num_threads = 1;
    ceres::CRSMatrix rows;
    Eigen::SimplicialLDLT<Matrix> information;
    bool is_known = ceres_.Evaluate(options, nullptr, nullptr, nullptr, &rows);
    if (is_known) {
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
    std::vector<Eigen::MatrixXd> result;
    for (size_t p = 0; p < planes_.size(); ++p) {
      std::vector<Eigen::Index> of_plane;
      for (Eigen::Index i = 0; i < planes_[p].axes.cols(); ++i) {
        of_plane.push_back(turns_[p] - parameters_.data() + i);
      }
      of_plane.push_back(shifts_[p] - parameters_.data());
      const size_t size = of_plane.size();
      result.emplace_back(Eigen::MatrixXd::Identity(size, size) /
                          (kPriorWeight * kPriorWeight));
      for (size_t i = 0; is_known && i < size; ++i) {
        const Eigen::VectorXd column = information.solve(
            Eigen::VectorXd::Unit(parameters_.size(), of_plane[i]));
        result.back().col(i) = column(of_plane);
      }
    }
    return result;
  }

  const MovingPlane& PlaneAt(size_t p) const { return planes_[p]; }

 private:
  static bool IsInFrame(const PlaneAdjustment& at, size_t p) {
    return p < at.axes.size() && at.axes[p].frame >= 0;
  }

  static Eigen::Vector3d ColumnOf(const PlaneAdjustment& at, size_t p) {
    return at.frames[at.axes[p].frame].col(at.axes[p].column);
  }

  void AddPlanes(const PlaneProblem& problem) {
    const PlaneAdjustment& at = problem.at;
    const size_t num_frames = at.frames.size();
    const size_t num_planes = at.planes.size();
    parameters_.resize(3 * (num_frames + num_planes));
    size_t end = 0;
    const auto add_block = [&](int size) {
      double* block = &parameters_[end];
      end += size;
      ceres_.AddResidualBlock(
          new ceres::NormalPrior(
              kPriorWeight * ceres::Matrix::Identity(size, size),
              ceres::Vector::Zero(size)),
          nullptr,
          block);
      return block;
    };
    for (size_t f = 0; f < num_frames; ++f) {
      add_block(3);
    }
    for (size_t p = 0; p < num_planes; ++p) {
      const WorldPlane& plane = at.planes[p];
      MovingPlane moving;
      moving.point =
          problem.middles[p] - plane.Height(problem.middles[p]) * plane.normal;
      moving.normal = plane.normal;
      moving.size = size_;
      if (IsInFrame(at, p)) {
        const Eigen::Vector3d column = ColumnOf(at, p);
        moving.normal = column.dot(plane.normal) < 0.0 ? -column : column;
        moving.axes = Eigen::Matrix3d::Identity();
        turns_.push_back(&parameters_[3 * at.axes[p].frame]);
      } else {
        moving.axes.resize(3, 2);
        moving.axes.col(0) = plane.normal.unitOrthogonal();
        moving.axes.col(1) = plane.normal.cross(moving.axes.col(0));
        turns_.push_back(add_block(2));
      }
      shifts_.push_back(add_block(1));
      planes_.push_back(moving);
    }
    parameters_.resize(end);
  }

  template <typename Error>
  void AddResidual(Error* error,
                   int num_residuals,
                   ceres::LossFunction* loss,
                   const std::vector<double*>& blocks) {
    // A stride of 4 derivatives covers nearly all measurements.
    auto* cost = new ceres::DynamicAutoDiffCostFunction<Error, 4>(error);
    for (double* block : blocks) {
      cost->AddParameterBlock(ceres_.ParameterBlockSize(block));
    }
    cost->SetNumResiduals(num_residuals);
    ceres_.AddResidualBlock(cost, loss, blocks);
  }

  double size_;
  ceres::Problem ceres_;
  std::vector<MovingPlane> planes_;
  std::vector<double> parameters_;
  std::vector<double*> turns_;  // By plane; point into the parameters.
  std::vector<double*> shifts_;
};

// of_numbers: the covariance of the plane's rotation and shift.
void SetCovariance(const MovingPlane& moving,
                   const Eigen::MatrixXd& of_parameters,
                   ModelPlane* plane) {
  const Eigen::Index num_axes = moving.axes.cols();
  Eigen::Matrix<double, 3, 2> along;
  along.col(0) = moving.normal.unitOrthogonal();
  along.col(1) = moving.normal.cross(along.col(0));
  Eigen::MatrixXd by_parameters = Eigen::MatrixXd::Zero(3, num_axes + 1);
  by_parameters.topLeftCorner(2, num_axes) = along.transpose() * moving.axes;
  by_parameters(2, num_axes) = 1.0;
  const Eigen::Matrix3d covariance =
      by_parameters * of_parameters * by_parameters.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      covariance.topLeftCorner<2, 2>());
  Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
  basis.topLeftCorner<2, 2>() = solver.eigenvectors();
  if (basis.determinant() < 0.0) {
    basis.col(1) = -basis.col(1);
  }
  plane->axis_s = along * basis.block<2, 1>(0, 0);
  plane->axis_t = along * basis.block<2, 1>(0, 1);
  const Eigen::Vector3d units(1.0, 1.0, moving.size);
  const Eigen::Matrix3d principal = basis.transpose() * covariance * basis;
  plane->covariance = units.asDiagonal() * principal * units.asDiagonal();
  for (int i = 0; i < 3; ++i) {
    if (!(principal(i, i) < kUnknownVariance)) {
      plane->covariance.row(i).setZero();
      plane->covariance.col(i).setZero();
      plane->covariance(i, i) = std::numeric_limits<double>::infinity();
    }
  }
}

}  // namespace

bool SolvePlanes(PlaneProblem* problem) {
  if (problem->at.planes.empty()) {
    return false;
  }
  CeresProblem solved(*problem);
  const bool moves = solved.Solve();
  solved.Move(&problem->at);
  return moves;
}

std::vector<ModelPlane> DescribePlanes(const PlaneProblem& problem) {
  if (problem.at.planes.empty()) {
    return {};
  }
  CeresProblem solved(problem);
  const std::vector<Eigen::MatrixXd> covariances = solved.Covariances();
  std::vector<ModelPlane> planes;
  for (size_t p = 0; p < covariances.size(); ++p) {
    ModelPlane plane;
    plane.plane = problem.at.planes[p];
    plane.center = solved.PlaneAt(p).point;
    SetCovariance(solved.PlaneAt(p), covariances[p], &plane);
    planes.push_back(plane);
  }
  return planes;
}

}  // namespace tsar
