// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/model_cylinder.h"

#include <map>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A plane of the scene, shared by all views that see it. World frame, units of
// the sparse model.
//
// Nobody measured those that begin where another plane ends at a crease
// (bounding_creases.h): their support is 0 and their centre lies on the crease.
// Their direction is that of the Manhattan frame, and that they have it is a
// guess, of which the covariance knows nothing: it is that of the crease's
// place.
struct ModelPlane {
  WorldPlane plane;
  // A point on it amid what was measured, and two orthogonal unit vectors along
  // it.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_s = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_t = Eigen::Vector3d::UnitY();
  // Of the rotation about axis_s and about axis_t (through the centre, radians)
  // and of the shift along the normal. Infinite variances: not known.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double support =
      0.0;            // What was measured of it, in pixels of full confidence.
  int component = 0;  // The connected set of views that it belongs to.
  // Its Manhattan frame, or -1, and the axis (column of the rotation) along
  // which its normal lies exactly, or -1.
  int frame = -1;
  int axis = -1;
};

// The planes, columns and pipes of a whole scene, and what every view shows of
// the planes.
struct SceneModel {
  std::vector<ModelPlane> planes;
  // Rotations whose columns are the axes, in the world frame.
  std::vector<Eigen::Matrix3d> frames;
  // Columns and pipes; those along one axis follow each other.
  std::vector<ModelCylinder> cylinders;
  // By image (index into the sparse model's images).
  std::map<int, ViewLabels> views;
};

}  // namespace tsar
