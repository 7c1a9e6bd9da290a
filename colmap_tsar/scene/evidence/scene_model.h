// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <map>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tsar {

// A frame of the plane across an axis, in the world: heights are along it.
struct AxisFrame {
  // Unit vectors at right angles.
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();

  Eigen::Vector3d Third() const { return along.cross(across); }
  Eigen::Vector2d Across(const Eigen::Vector3d& world) const {
    return {across.dot(world), Third().dot(world)};
  }
  bool operator==(const AxisFrame& other) const {
    return along == other.along && across == other.across;
  }
};

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

// A column or a pipe of the scene, which is known by its outlines
// (OutlinePair): a straight circular cylinder along an axis of a Manhattan
// frame. World frame, units of the sparse model.
struct ModelCylinder {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // On its axis.
  AxisFrame frame;  // Along the cylinder, and across it.
  double radius = 1.0;
  // The part of it that was seen: from where to where along its axis, as of
  // `point`.
  double min_height = 0.0;
  double max_height = 0.0;
  // Of the shifts along frame.across and frame.Third(), and of the radius.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
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
