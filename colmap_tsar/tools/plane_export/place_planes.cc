// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/place_planes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <Eigen/Geometry>

namespace tsar {
namespace {

void Scale(double factor, Ring* ring) {
  for (Eigen::Vector2d& point : *ring) {
    point *= factor;
  }
}

}  // namespace

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
    PlaneCoordinates& coordinates = plane.coordinates;
    for (Eigen::Vector3d* vector : {&coordinates.origin,
                                    &coordinates.axis_s,
                                    &coordinates.axis_t,
                                    &coordinates.normal}) {
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
