// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/scene/adjustment/plane_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace tsar {
namespace {

// Tolerance of the lengths of normals.
constexpr double kUnitTolerance = 1e-6;

void Require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument("AdjustPlanes: " + std::string(what));
  }
}

void CheckPlanes(const std::vector<WorldPlane>& planes) {
  for (const WorldPlane& plane : planes) {
    Require(std::isfinite(plane.offset) &&
                std::abs(plane.normal.norm() - 1.0) < kUnitTolerance,
            "a plane is not finite, or its normal not of unit length");
  }
}

void CheckMeasurements(const std::vector<PlaneMeasurement>& measurements) {
  for (const PlaneMeasurement& measurement : measurements) {
    Require(measurement.center.allFinite() && measurement.form.allFinite() &&
                measurement.foot.allFinite() &&
                std::isfinite(measurement.information),
            "a measurement is not finite");
  }
}

// The center and the size of a scene: thresholds must depend neither on the
// origin nor on the unit of length.
struct SceneExtent {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double size = 1.0;  // Above 0.
};

// The median of the measured points and camera centers, and the median of their
// distances from it, robust to few that are far away; without measurements, of
// the planes' points nearest to the origin.
SceneExtent ExtentOf(const std::vector<WorldPlane>& planes,
                     const std::vector<PlaneMeasurement>& measurements) {
  std::vector<Eigen::Vector3d> points;
  for (const PlaneMeasurement& measurement : measurements) {
    if (measurement.information > 0.0) {
      points.push_back(measurement.center);
      points.push_back(measurement.foot);
    }
  }
  if (points.empty()) {
    for (const WorldPlane& plane : planes) {
      points.emplace_back(-plane.offset * plane.normal);
    }
  }
  if (points.empty()) {
    return {};
  }
  SceneExtent extent;
  std::vector<double> values(points.size());
  for (int i = 0; i < 3; ++i) {
    for (size_t k = 0; k < points.size(); ++k) {
      values[k] = points[k][i];
    }
    extent.middle[i] = UpperMedian(&values);
  }
  for (size_t k = 0; k < points.size(); ++k) {
    values[k] = (points[k] - extent.middle).norm();
  }
  const double size = UpperMedian(&values);
  Require(std::isfinite(size), "lengths are too large");
  extent.size = size > 0.0 ? size : 1.0;
  return extent;
}

// The center of the measurements of each plane, where it is known best.
std::vector<Eigen::Vector3d> Middles(
    const std::vector<PlaneMeasurement>& measurements,
    const SceneExtent& extent,
    size_t num_planes) {
  std::vector<Eigen::Vector3d> sums(num_planes, Eigen::Vector3d::Zero());
  std::vector<double> weights(num_planes, 0.0);
  for (const PlaneMeasurement& measurement : measurements) {
    sums[measurement.plane] +=
        measurement.information * (measurement.foot - extent.middle);
    weights[measurement.plane] += measurement.information;
  }
  for (size_t p = 0; p < num_planes; ++p) {
    sums[p] = weights[p] > 0.0
                  ? Eigen::Vector3d(extent.middle + sums[p] / weights[p])
                  : extent.middle;
  }
  return sums;
}

// Sine of 3 degrees, and 0.5 degrees in radians.
constexpr double kSinMaxAngle = 0.0523;
constexpr double kSigma = 0.00873;
// The largest number of priors of a plane, and of planes of its component that
// are tried.
constexpr int kMaxPartners = 3;
constexpr size_t kMaxTried = 30;

std::optional<PlaneAnglePrior> FindPrior(const std::vector<ModelPlane>& planes,
                                         int first,
                                         int second) {
  using Kind = PlaneAnglePrior::Kind;
  const Eigen::Vector3d& a = planes[first].plane.normal;
  const Eigen::Vector3d& b = planes[second].plane.normal;
  if (std::abs(a.dot(b)) < kSinMaxAngle) {
    return PlaneAnglePrior{Kind::kOrthogonal, first, second, kSigma};
  }
  if (a.cross(b).norm() < kSinMaxAngle) {
    return PlaneAnglePrior{Kind::kParallel, first, second, kSigma};
  }
  return std::nullopt;
}

// Whether the normal is the axis of the frame up to rounding.
bool IsAlongAxis(const ModelPlane& plane,
                 const std::vector<Eigen::Matrix3d>& frames) {
  return plane.frame >= 0 &&
         frames[plane.frame].col(plane.axis).cross(plane.plane.normal).norm() <
             1e-9;
}

// Sets the covariance of an adjusted plane on the plane that it was adjusted
// from, which differs slightly.
void SetUncertainty(const ModelPlane& from, ModelPlane* plane) {
  plane->covariance = from.covariance;
  // Otherwise the center is not that of the measurements.
  if (!std::isfinite(from.covariance(2, 2))) {
    return;
  }
  const Eigen::Vector3d& normal = plane->plane.normal;
  plane->center = from.center - plane->plane.Height(from.center) * normal;
  plane->axis_s = (from.axis_s - from.axis_s.dot(normal) * normal).normalized();
  plane->axis_t = normal.cross(plane->axis_s);
}

}  // namespace

AdjustedPlanes AdjustPlanes(const PlaneAdjustment& adjustment,
                            const MeasurePlanes& measure,
                            int max_rounds) {
  CheckPlanes(adjustment.planes);
  const size_t num_planes = adjustment.planes.size();
  PlaneProblem problem;
  problem.at = adjustment;
  SceneExtent extent;
  bool moves = true;
  for (int round = 0; moves && round < max_rounds; ++round) {
    problem.measurements = measure(problem.at.planes);
    CheckMeasurements(problem.measurements);
    if (round == 0) {
      extent = ExtentOf(adjustment.planes, problem.measurements);
      problem.size = extent.size;
    }
    problem.middles = Middles(problem.measurements, extent, num_planes);
    moves = SolvePlanes(&problem);
  }
  AdjustedPlanes result;
  result.planes = DescribePlanes(problem);
  for (size_t p = 0; p < num_planes; ++p) {
    ModelPlane& plane = result.planes[p];
    if (plane.covariance.diagonal().array().isInf().all() &&
        (adjustment.axes.empty() || adjustment.axes[p].frame < 0)) {
      plane.plane = adjustment.planes[p];
    }
  }
  result.frames = problem.at.frames;
  return result;
}

std::vector<PlaneAnglePrior> FindAnglePriors(
    const std::vector<ModelPlane>& planes) {
  std::map<int, std::vector<int>> tried;  // By component.
  std::vector<PlaneAnglePrior> priors;
  for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
    const ModelPlane& plane = planes[p];
    std::vector<int>& before = tried[plane.component];
    int num_partners = 0;
    for (size_t i = 0;
         i < before.size() && num_partners < kMaxPartners && plane.axis < 0;
         ++i) {
      if (const auto prior = FindPrior(planes, before[i], p)) {
        priors.push_back(*prior);
        ++num_partners;
      }
    }
    if (before.size() < kMaxTried) {
      before.push_back(p);
    }
  }
  return priors;
}

void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model) {
  PlaneAdjustment adjustment;
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (!may_move[p] && !IsAlongAxis(plane, model->frames)) {
      plane.frame = plane.axis = -1;
    }
    adjustment.planes.push_back(plane.plane);
    adjustment.axes.push_back({plane.frame, plane.axis});
  }
  adjustment.frames = model->frames;
  adjustment.angles = FindAnglePriors(model->planes);
  // Where nothing may move, one measurement is enough.
  const bool any_may_move = std::ranges::find(may_move, true) != may_move.end();
  const AdjustedPlanes adjusted =
      any_may_move ? AdjustPlanes(adjustment, measure)
                   : AdjustPlanes(adjustment, measure, /*max_rounds=*/1);
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (may_move[p]) {
      plane.plane = adjusted.planes[p].plane;
      if (plane.frame >= 0) {
        model->frames[plane.frame] = adjusted.frames[plane.frame];
      }
    }
    SetUncertainty(adjusted.planes[p], &plane);
  }
}

}  // namespace tsar
