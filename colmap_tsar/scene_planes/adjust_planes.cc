// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_planes.h"

#include "colmap_tsar/scene_planes/plane_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

namespace tsar {
namespace {

// In radians and sizes of the scene; without any evidence variances are far
// larger.
constexpr double kUnknownVariance = 0.25;
// How far lengths of normals and the columns of rotations may be off.
constexpr double kUnitTolerance = 1e-6;
constexpr double kMinSigma = 1e-9;

void Require(bool condition, const char* kind, size_t index, const char* what) {
  if (!condition) {
    throw std::invalid_argument("AdjustPlanes: " + std::string(kind) + " " +
                                std::to_string(index) + " " + what);
  }
}

bool IsIndex(int index, size_t size) {
  return index >= 0 && static_cast<size_t>(index) < size;
}

void CheckAdjustment(const PlaneAdjustment& adjustment,
                     const AdjustPlanesOptions& options) {
  const size_t num_planes = adjustment.planes.size();
  for (size_t i = 0; i < num_planes; ++i) {
    const WorldPlane& plane = adjustment.planes[i];
    Require(std::isfinite(plane.offset) &&
                std::abs(plane.normal.norm() - 1.0) < kUnitTolerance,
            "plane",
            i,
            "is not finite, or its normal not of unit length");
  }
  for (size_t i = 0; i < adjustment.frames.size(); ++i) {
    const Eigen::Matrix3d& frame = adjustment.frames[i];
    Require(
        frame.determinant() > 0.0 &&
            (frame.transpose() * frame - Eigen::Matrix3d::Identity()).norm() <
                kUnitTolerance,
        "frame",
        i,
        "is no rotation");
  }
  const size_t num_axes = adjustment.axes.size();
  Require(num_axes == 0 || num_axes == num_planes,
          "the list of axes, of size",
          num_axes,
          "has not one for each plane");
  for (size_t i = 0; i < num_axes; ++i) {
    const FrameColumn& axis = adjustment.axes[i];
    Require(
        axis.frame == -1 || (IsIndex(axis.frame, adjustment.frames.size()) &&
                             IsIndex(axis.column, 3)),
        "the axis of plane",
        i,
        "names no column of a frame");
  }
  for (size_t i = 0; i < adjustment.angles.size(); ++i) {
    const PlaneAnglePrior& angle = adjustment.angles[i];
    Require(IsIndex(angle.first, num_planes) &&
                IsIndex(angle.second, num_planes) &&
                angle.first != angle.second && angle.sigma > kMinSigma &&
                std::isfinite(angle.sigma),
            "angle",
            i,
            "is not of two planes, or its sigma out of range");
  }
  if (options.max_rounds < 1 || !(options.loss_scale > 0.0) ||
      !std::isfinite(options.loss_scale)) {
    throw std::invalid_argument(
        "AdjustPlanes: max_rounds has to be 1 at least, loss_scale above 0");
  }
}

void CheckMeasurements(const std::vector<PlaneMeasurement>& measurements,
                       size_t num_planes) {
  for (size_t i = 0; i < measurements.size(); ++i) {
    const PlaneMeasurement& measurement = measurements[i];
    Require(IsIndex(measurement.plane, num_planes) &&
                measurement.center.allFinite() &&
                measurement.form.allFinite() && measurement.foot.allFinite() &&
                std::isfinite(measurement.information) &&
                measurement.information >= 0.0,
            "measurement",
            i,
            "is of no plane, not finite, or its information below 0");
  }
}

// The upper one of two; leaves the values in another order.
double Median(std::vector<double>* values) {
  const auto middle =
      values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

// Where a scene is, and how large: thresholds must depend neither on the origin
// nor on the unit of length.
struct SceneExtent {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  double size = 1.0;  // Above 0.
};

// The median of the places, and of their distances from there, so that few that
// are far away do not matter. A size of 0 where all are one place.
SceneExtent ExtentOf(const std::vector<Eigen::Vector3d>& places) {
  SceneExtent extent;
  std::vector<double> values(places.size());
  for (int i = 0; i < 3; ++i) {
    std::transform(places.begin(),
                   places.end(),
                   values.begin(),
                   [&](const Eigen::Vector3d& place) { return place[i]; });
    extent.middle[i] = Median(&values);
  }
  double sum = 0.0;
  for (size_t k = 0; k < places.size(); ++k) {
    values[k] = (places[k] - extent.middle).norm();
    sum += values[k];
  }
  extent.size = Median(&values);
  if (!(extent.size > 0.0)) {
    extent.size = sum / static_cast<double>(places.size());
  }
  return extent;
}

// Amid the places where planes were measured and from where; or, where there
// are none, amid the planes' points that are nearest to the origin.
SceneExtent ExtentOf(const std::vector<WorldPlane>& planes,
                     const std::vector<PlaneMeasurement>& measurements) {
  std::vector<Eigen::Vector3d> places;
  for (const PlaneMeasurement& measurement : measurements) {
    if (measurement.information > 0.0) {
      places.push_back(measurement.center);
      places.push_back(measurement.foot);
    }
  }
  if (places.empty()) {
    for (const WorldPlane& plane : planes) {
      places.emplace_back(-plane.offset * plane.normal);
    }
  }
  SceneExtent extent;
  if (!places.empty()) {
    extent = ExtentOf(places);
  }
  if (!std::isfinite(extent.size)) {
    throw std::invalid_argument("AdjustPlanes: lengths are too large");
  }
  if (!(extent.size > 0.0)) {
    extent.size = 1.0;
  }
  return extent;
}

// Where each plane is known best: amid what was measured of it.
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

// Whether anything is known of the plane beside where it was.
bool SetCovariance(const PlaneKnowledge& knowledge,
                   double size,
                   AdjustedPlane* plane) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      knowledge.covariance.topLeftCorner<2, 2>());
  Eigen::Matrix3d basis = Eigen::Matrix3d::Identity();
  basis.topLeftCorner<2, 2>() = solver.eigenvectors();
  if (basis.determinant() < 0.0) {
    basis.col(1) = -basis.col(1);
  }
  plane->axis_s =
      basis(0, 0) * knowledge.axis_s + basis(1, 0) * knowledge.axis_t;
  plane->axis_t =
      basis(0, 1) * knowledge.axis_s + basis(1, 1) * knowledge.axis_t;
  const Eigen::Vector3d units(1.0, 1.0, size);
  const Eigen::Matrix3d principal =
      basis.transpose() * knowledge.covariance * basis;
  plane->covariance = units.asDiagonal() * principal * units.asDiagonal();
  bool is_known = false;
  for (int i = 0; i < 3; ++i) {
    if (principal(i, i) < kUnknownVariance) {
      is_known = true;
    } else {
      plane->covariance.row(i).setZero();
      plane->covariance.col(i).setZero();
      plane->covariance(i, i) = std::numeric_limits<double>::infinity();
    }
  }
  return is_known;
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
  const std::vector<PlaneKnowledge> knowledge = ComputeKnowledge(problem);
  for (size_t p = 0; p < num_planes; ++p) {
    AdjustedPlane plane;
    plane.plane = problem.at.planes[p];
    plane.center = knowledge[p].center;
    const bool is_known = SetCovariance(knowledge[p], extent.size, &plane);
    if (!is_known &&
        (adjustment.axes.empty() || adjustment.axes[p].frame < 0)) {
      plane.plane = adjustment.planes[p];
    }
    result.planes.push_back(plane);
  }
  result.frames = problem.at.frames;
  return result;
}

}  // namespace tsar
