// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/check_adjustment.h"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include <Eigen/LU>

namespace tsar {
namespace {

// How far lengths of normals and the columns of rotations may be off.
constexpr double kUnitTolerance = 1e-6;

void Require(bool condition, const char* kind, size_t index, const char* what) {
  if (!condition) {
    throw std::invalid_argument("AdjustPlanes: " + std::string(kind) + " " +
                                std::to_string(index) + " " + what);
  }
}

bool IsIndex(int index, size_t size) {
  return index >= 0 && static_cast<size_t>(index) < size;
}

bool IsPair(int first, int second, size_t num_planes) {
  return IsIndex(first, num_planes) && IsIndex(second, num_planes) &&
         first != second;
}

bool IsPositive(double value) { return std::isfinite(value) && value > 0.0; }

bool IsRotation(const Eigen::Matrix3d& matrix) {
  return matrix.allFinite() && matrix.determinant() > 0.0 &&
         (matrix.transpose() * matrix - Eigen::Matrix3d::Identity())
                 .cwiseAbs()
                 .maxCoeff() < kUnitTolerance;
}

void CheckPlanes(const PlaneAdjustment& adjustment) {
  const size_t num_planes = adjustment.planes.size();
  for (size_t i = 0; i < num_planes; ++i) {
    const WorldPlane& plane = adjustment.planes[i];
    Require(plane.normal.allFinite() && std::isfinite(plane.offset),
            "plane",
            i,
            "is not finite");
    Require(std::abs(plane.normal.norm() - 1.0) < kUnitTolerance,
            "plane",
            i,
            "has a normal that is not of unit length");
  }
  for (size_t i = 0; i < adjustment.frames.size(); ++i) {
    Require(IsRotation(adjustment.frames[i]), "frame", i, "is no rotation");
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
}

}  // namespace

void CheckAdjustment(const PlaneAdjustment& adjustment,
                     const AdjustPlanesOptions& options) {
  CheckPlanes(adjustment);
  const size_t num_planes = adjustment.planes.size();
  for (size_t i = 0; i < adjustment.points.size(); ++i) {
    const PointOnPlane& point = adjustment.points[i];
    Require(IsIndex(point.plane, num_planes), "point", i, "is on no plane");
    Require(point.point.allFinite() && IsPositive(point.sigma),
            "point",
            i,
            "is not finite, or its sigma not above 0");
  }
  for (size_t i = 0; i < adjustment.creases.size(); ++i) {
    const PlaneCrease& crease = adjustment.creases[i];
    Require(IsPair(crease.first, crease.second, num_planes),
            "crease",
            i,
            "is not of two planes");
    const bool valid =
        crease.center.allFinite() && crease.rays[0].allFinite() &&
        crease.rays[1].allFinite() && IsPositive(crease.relative_sigma);
    Require(valid, "crease", i, "is not finite, or its sigma not above 0");
  }
  for (size_t i = 0; i < adjustment.angles.size(); ++i) {
    const PlaneAnglePrior& angle = adjustment.angles[i];
    Require(IsPair(angle.first, angle.second, num_planes),
            "angle",
            i,
            "is not of two planes");
    Require(IsPositive(angle.sigma), "angle", i, "has no sigma above 0");
  }
  if (options.max_rounds < 1 || !IsPositive(options.loss_scale)) {
    throw std::invalid_argument(
        "AdjustPlanes: max_rounds has to be 1 at least, loss_scale above 0");
  }
}

void CheckMeasurements(const std::vector<PlaneMeasurement>& measurements,
                       int num_planes) {
  for (size_t i = 0; i < measurements.size(); ++i) {
    const PlaneMeasurement& measurement = measurements[i];
    Require(IsIndex(measurement.plane, num_planes),
            "measurement",
            i,
            "is of no plane");
    const bool valid = measurement.center.allFinite() &&
                       measurement.form.allFinite() &&
                       measurement.foot.allFinite() &&
                       std::isfinite(measurement.information) &&
                       measurement.information >= 0.0;
    Require(
        valid, "measurement", i, "is not finite, or its information below 0");
  }
}

}  // namespace tsar
