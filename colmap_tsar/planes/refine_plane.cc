// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/refine_plane.h"

#include <cmath>
#include <deque>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <ceres/ceres.h>

namespace tsar {
namespace {

constexpr int kMinObservations = 10;
// A support whose width is below this share of its length is a line.
constexpr double kMinRelativeWidth = 0.01;

// The residual of one observation by the plane's unit normal and its offset.
class DepthResidual : public ceres::SizedCostFunction<1, 3, 1> {
 public:
  explicit DepthResidual(const DepthObservation& observation)
      : observation_(observation), point_(observation.Point()) {}

  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const WorldPlane plane = {Eigen::Vector3d(parameters[0]), parameters[1][0]};
    residuals[0] = NormalizedResidual(plane, observation_);
    if (jacobians == nullptr) {
      return true;
    }
    const double slope = plane.normal.dot(observation_.ray);
    const double bounded_slope = RaySlope(plane, observation_);
    const double by_height = 1.0 / (bounded_slope * observation_.sigma);
    if (jacobians[0] != nullptr) {
      Eigen::Vector3d by_normal = by_height * point_;
      if (std::abs(slope) >= bounded_slope) {
        by_normal -= residuals[0] / slope * observation_.ray;
      }
      Eigen::Vector3d::Map(jacobians[0]) = by_normal;
    }
    if (jacobians[1] != nullptr) {
      jacobians[1][0] = by_height;
    }
    return true;
  }

 private:
  DepthObservation observation_;
  Eigen::Vector3d point_;
};

// How much an observation counts at a plane, by the loss's derivative.
double RobustWeight(const WorldPlane& plane,
                    const DepthObservation& observation,
                    double loss_scale) {
  const double residual = NormalizedResidual(plane, observation) / loss_scale;
  return observation.weight / (1.0 + residual * residual);
}

// Maps the scene to one around the origin, of about unit size.
struct Normalization {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double spread = 0.0;

  WorldPlane Apply(const WorldPlane& plane) const {
    return {plane.normal, plane.Height(center) / spread};
  }
  DepthObservation Apply(const DepthObservation& observation) const {
    DepthObservation result = observation;
    result.center = (observation.center - center) / spread;
    result.depth /= spread;
    result.sigma /= spread;
    return result;
  }
  WorldPlane Undo(const WorldPlane& plane) const {
    return {plane.normal, plane.offset * spread - plane.normal.dot(center)};
  }
};

// From the middle and the extent of the observed points, in which outliers
// count as little as they do in the fit.
Normalization ComputeNormalization(
    const WorldPlane& plane,
    const std::vector<DepthObservation>& observations,
    double loss_scale) {
  double weights = 0.0;
  Normalization normalization;
  for (const DepthObservation& observation : observations) {
    const double weight = RobustWeight(plane, observation, loss_scale);
    weights += weight;
    normalization.center += weight * observation.Point();
  }
  normalization.center /= weights;
  double squares = 0.0;
  for (const DepthObservation& observation : observations) {
    squares += RobustWeight(plane, observation, loss_scale) *
               (observation.Point() - normalization.center).squaredNorm();
  }
  normalization.spread = std::sqrt(squares / weights);
  return normalization;
}

// Whether the rays meet the plane in more than a line, about which it could
// turn without a change of any depth.
bool IsDetermined(const WorldPlane& plane,
                  const std::vector<DepthObservation>& observations,
                  double loss_scale) {
  double weights = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const DepthObservation& observation : observations) {
    const double weight = RobustWeight(plane, observation, loss_scale);
    weights += weight;
    mean += weight * FootPoint(plane, observation);
  }
  mean /= weights;
  const Eigen::Vector3d tangent = plane.normal.unitOrthogonal();
  const Eigen::Vector3d other_tangent = plane.normal.cross(tangent);
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const DepthObservation& observation : observations) {
    const Eigen::Vector3d foot = FootPoint(plane, observation) - mean;
    const Eigen::Vector2d position(tangent.dot(foot), other_tangent.dot(foot));
    scatter += RobustWeight(plane, observation, loss_scale) * position *
               position.transpose();
  }
  const Eigen::Vector2d squares =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(scatter,
                                                     Eigen::EigenvaluesOnly)
          .eigenvalues();
  // Also false where something is not a number.
  return squares[0] > kMinRelativeWidth * kMinRelativeWidth * squares[1];
}

// Of observations of about unit size around the origin. False where it fails.
bool Minimize(const std::vector<DepthObservation>& observations,
              const RefinePlaneOptions& options,
              WorldPlane* plane) {
  // Declared before the problem that refers to them.
  std::deque<DepthResidual> residuals;
  std::deque<ceres::ScaledLoss> losses;
  ceres::CauchyLoss cauchy(options.loss_scale);
  ceres::SphereManifold<3> sphere;

  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(problem_options);
  problem.AddParameterBlock(plane->normal.data(), 3, &sphere);
  problem.AddParameterBlock(&plane->offset, 1);
  for (const DepthObservation& observation : observations) {
    residuals.emplace_back(observation);
    losses.emplace_back(
        &cauchy, observation.weight, ceres::DO_NOT_TAKE_OWNERSHIP);
    problem.AddResidualBlock(&residuals.back(),
                             &losses.back(),
                             plane->normal.data(),
                             &plane->offset);
  }

  ceres::Solver::Options solver_options;
  solver_options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver_options.max_num_iterations = options.max_iterations;
  // The loss is flat around its minimum: a plane that is off by a thousandth of
  // an error adds a millionth.
  solver_options.function_tolerance = 1e-12;
  solver_options.num_threads = 1;
  solver_options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options, &problem, &summary);
  // Ceres takes a cost that overflows for a minimum.
  return summary.IsSolutionUsable() && std::isfinite(summary.final_cost);
}

}  // namespace

WorldPlane RefinePlane(const WorldPlane& initial,
                       const std::vector<DepthObservation>& observations,
                       const RefinePlaneOptions& options) {
  std::vector<DepthObservation> counting;
  counting.reserve(observations.size());
  for (const DepthObservation& observation : observations) {
    if (observation.weight > 0.0) {
      counting.push_back(observation);
    }
  }
  if (counting.size() < kMinObservations) {
    return initial;
  }
  const Normalization normalization =
      ComputeNormalization(initial, counting, options.loss_scale);
  if (!(normalization.spread > 0.0)) {
    return initial;
  }
  WorldPlane plane = normalization.Apply(initial);
  for (DepthObservation& observation : counting) {
    observation = normalization.Apply(observation);
  }
  // Only now, since views from several sides of one line meet another plane in
  // several lines.
  if (!Minimize(counting, options, &plane) ||
      !IsDetermined(plane, counting, options.loss_scale)) {
    return initial;
  }
  plane.offset /= plane.normal.norm();
  plane.normal.normalize();
  return normalization.Undo(plane);
}

}  // namespace tsar
