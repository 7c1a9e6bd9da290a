// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/exported_planes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kSine15 = 0.25881904510252074;
constexpr double kCosine15 = 0.9659258262890683;
constexpr double kCosine30 = 0.8660254037844387;
// The least length of a meaningful mean of unit vectors.
constexpr double kMinMeanUp = 0.2;

void Scale(double factor, Ring* ring) {
  for (Eigen::Vector2d& point : *ring) {
    point *= factor;
  }
}

}  // namespace

Vertical FindVertical(const std::vector<Eigen::Vector3d>& camera_ups,
                      const std::vector<Eigen::Matrix3d>& frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& up : camera_ups) {
    sum += up;
  }
  Vertical vertical;
  if (sum.norm() <= kMinMeanUp * static_cast<double>(camera_ups.size())) {
    return vertical;
  }
  vertical.up = sum.normalized();
  vertical.source = Vertical::Source::kCameras;
  const Eigen::Vector3d mean = vertical.up;
  double best = kCosine30;
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine = frame.col(axis).dot(mean);
      if (std::abs(cosine) > best) {
        best = std::abs(cosine);
        vertical.up = (cosine < 0.0 ? -1.0 : 1.0) * frame.col(axis);
        vertical.source = Vertical::Source::kFrame;
      }
    }
  }
  return vertical;
}

PlaneClass ClassifyPlane(const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& point,
                         const std::vector<Eigen::Vector3d>& cameras,
                         const Vertical& vertical) {
  if (vertical.source == Vertical::Source::kNone) {
    return PlaneClass::kOther;
  }
  const double cosine = normal.dot(vertical.up);
  if (std::abs(cosine) <= kSine15) {
    return PlaneClass::kWall;
  }
  if (std::abs(cosine) < kCosine15 || cameras.empty()) {
    return PlaneClass::kOther;
  }
  const Eigen::Vector3d upwards = (cosine < 0.0 ? -1.0 : 1.0) * normal;
  const auto num_above =
      std::ranges::count_if(cameras, [&](const Eigen::Vector3d& camera) {
        return upwards.dot(camera - point) > 0.0;
      });
  return 2 * static_cast<size_t>(num_above) >= cameras.size()
             ? PlaneClass::kFloor
             : PlaneClass::kCeiling;
}

void TurnUp(UpAxis axis, ExportedPlanes* planes) {
  if (axis == UpAxis::kModel) {
    return;
  }
  if (planes->vertical.source == Vertical::Source::kNone) {
    throw Error(ErrorCode::kUnsupported,
                OptionName("up") +
                    ": the cameras look all ways, so that nothing tells what "
                    "is up; leave the option out");
  }
  Eigen::Matrix3d rotation = Eigen::Quaterniond::FromTwoVectors(
                                 planes->vertical.up, Eigen::Vector3d::UnitZ())
                                 .toRotationMatrix();
  planes->vertical.up = Eigen::Vector3d::UnitZ();
  if (axis == UpAxis::kY) {
    Eigen::Matrix3d y_from_z;
    y_from_z << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    rotation = y_from_z * rotation;
    planes->vertical.up = Eigen::Vector3d::UnitY();
  }
  planes->from_model = rotation * planes->from_model;
  for (Eigen::Matrix3d& frame : planes->frames) {
    frame = rotation * frame;
  }
  for (ExportedPlane& plane : planes->planes) {
    PlaneCoordinates& at = plane.coordinates;
    for (Eigen::Vector3d* vector :
         {&at.origin, &at.axis_s, &at.axis_t, &at.normal}) {
      *vector = rotation * *vector;
    }
  }
}

void ScaleToMeters(double meters_per_unit, ExportedPlanes* planes) {
  planes->in_meters = true;
  planes->from_model *= meters_per_unit;
  for (ExportedPlane& plane : planes->planes) {
    plane.coordinates.origin *= meters_per_unit;
    // Its rotations are angles.
    plane.covariance.row(2) *= meters_per_unit;
    plane.covariance.col(2) *= meters_per_unit;
    plane.area *= meters_per_unit * meters_per_unit;
    plane.cell *= meters_per_unit;
    for (PlanePolygon& polygon : plane.polygons) {
      Scale(meters_per_unit, &polygon.outline);
      for (Ring& hole : polygon.holes) {
        Scale(meters_per_unit, &hole);
      }
    }
  }
}

}  // namespace tsar
