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

// Tolerance of the lengths of normals and of the columns of rotations.
constexpr double kUnitTolerance = 1e-6;
constexpr double kMinSigma = 1e-9;

void Require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument("AdjustPlanes: " + std::string(what));
  }
}

bool IsIndex(int index, size_t size) {
  return index >= 0 && static_cast<size_t>(index) < size;
}

bool IsPositive(double value) { return std::isfinite(value) && value > 0.0; }

void CheckAdjustment(const PlaneAdjustment& adjustment,
                     const AdjustPlanesOptions& options) {
  const size_t num_planes = adjustment.planes.size();
  for (const WorldPlane& plane : adjustment.planes) {
    Require(std::isfinite(plane.offset) &&
                std::abs(plane.normal.norm() - 1.0) < kUnitTolerance,
            "a plane is not finite, or its normal not of unit length");
  }
  for (const Eigen::Matrix3d& frame : adjustment.frames) {
    Require(frame.determinant() > 0.0 && frame.isUnitary(kUnitTolerance),
            "a frame is no rotation");
  }
  Require(adjustment.axes.empty() || adjustment.axes.size() == num_planes,
          "the list of axes has not one for each plane");
  for (const FrameColumn& axis : adjustment.axes) {
    Require(
        axis.frame == -1 || (IsIndex(axis.frame, adjustment.frames.size()) &&
                             IsIndex(axis.column, 3)),
        "an axis is no column of a frame");
  }
  for (const PlaneAnglePrior& angle : adjustment.angles) {
    Require(IsIndex(angle.first, num_planes) &&
                IsIndex(angle.second, num_planes) &&
                angle.first != angle.second,
            "an angle is not of two planes");
    Require(IsPositive(angle.sigma) && angle.sigma >= kMinSigma,
            "the sigma of an angle is out of range");
  }
  Require(options.max_rounds >= 1 && IsPositive(options.loss_scale),
          "max_rounds has to be 1 at least, loss_scale above 0");
}

void CheckMeasurements(const std::vector<PlaneMeasurement>& measurements,
                       size_t num_planes) {
  for (const PlaneMeasurement& measurement : measurements) {
    Require(IsIndex(measurement.plane, num_planes),
            "a measurement is of no plane");
    Require(measurement.center.allFinite() && measurement.form.allFinite() &&
                measurement.foot.allFinite() &&
                std::isfinite(measurement.information) &&
                measurement.information >= 0.0,
            "a measurement is not finite, or its information below 0");
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
  SceneExtent extent;
  if (points.empty()) {
    return extent;
  }
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
    const auto p = static_cast<size_t>(measurement.plane);
    sums[p] += measurement.information * (measurement.foot - extent.middle);
    weights[p] += measurement.information;
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
  const Eigen::Vector3d& a = planes[static_cast<size_t>(first)].plane.normal;
  const Eigen::Vector3d& b = planes[static_cast<size_t>(second)].plane.normal;
  if (std::abs(a.dot(b)) < kSinMaxAngle) {
    return PlaneAnglePrior{
        PlaneAnglePrior::Kind::kOrthogonal, first, second, kSigma};
  }
  if (a.cross(b).norm() < kSinMaxAngle) {
    return PlaneAnglePrior{
        PlaneAnglePrior::Kind::kParallel, first, second, kSigma};
  }
  return std::nullopt;
}

// Whether the normal is the axis of the frame up to rounding.
bool IsAlongAxis(const ModelPlane& plane,
                 const std::vector<Eigen::Matrix3d>& frames) {
  return plane.frame >= 0 && frames[static_cast<size_t>(plane.frame)]
                                     .col(plane.axis)
                                     .cross(plane.plane.normal)
                                     .norm() < 1e-9;
}

// Sets the covariance of an adjusted plane on the plane that it was adjusted
// from, which differs slightly.
void SetKnowledge(const AdjustedPlane& from, ModelPlane* plane) {
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
                            const AdjustPlanesOptions& options) {
  CheckAdjustment(adjustment, options);
  const size_t num_planes = adjustment.planes.size();
  AdjustedPlanes result;
  PlaneProblem problem;
  problem.at = adjustment;
  problem.loss_scale = options.loss_scale;
  SceneExtent extent;
  bool moves = true;
  while (moves && result.num_rounds < options.max_rounds) {
    problem.measurements = measure(problem.at.planes);
    CheckMeasurements(problem.measurements, num_planes);
    if (result.num_rounds == 0) {
      extent = ExtentOf(adjustment.planes, problem.measurements);
      problem.size = extent.size;
    }
    problem.middles = Middles(problem.measurements, extent, num_planes);
    moves = SolvePlanes(&problem);
    ++result.num_rounds;
  }
  result.planes = DescribePlanes(problem);
  for (size_t p = 0; p < num_planes; ++p) {
    AdjustedPlane& plane = result.planes[p];
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
    const ModelPlane& plane = planes[static_cast<size_t>(p)];
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
  AdjustPlanesOptions options;
  if (std::find(may_move.begin(), may_move.end(), true) == may_move.end()) {
    options.max_rounds = 1;  // One measurement is enough.
  }
  const AdjustedPlanes adjusted = AdjustPlanes(adjustment, measure, options);
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (may_move[p]) {
      plane.plane = adjusted.planes[p].plane;
      if (plane.frame >= 0) {
        const auto frame = static_cast<size_t>(plane.frame);
        model->frames[frame] = adjusted.frames[frame];
      }
    }
    SetKnowledge(adjusted.planes[p], &plane);
  }
}

}  // namespace tsar
