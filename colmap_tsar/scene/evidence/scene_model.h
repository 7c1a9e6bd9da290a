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

// An axis and a frame of the plane across it, in the world; heights are along
// the axis.
struct AxisFrame {
  // Orthogonal unit vectors.
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
// Planes that begin where another plane ends at a crease (bounding_creases.h)
// were not measured: their support is 0 and their center lies on the crease.
// Their normal is assumed to be that of the Manhattan frame; the covariance
// does not include the error of this assumption, only that of the crease's
// position.
struct ModelPlane {
  WorldPlane plane;
  // A point on the plane near the center of its measurements, and two
  // orthogonal unit vectors in the plane.
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_s = Eigen::Vector3d::UnitX();
  Eigen::Vector3d axis_t = Eigen::Vector3d::UnitY();
  // Covariance of the rotations about axis_s and axis_t (through the center, in
  // radians) and of the shift along the normal. Unknown variances are infinite.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double support =
      0.0;            // Sum of its measurements, in pixels of full confidence.
  int component = 0;  // Connected component of views it belongs to.
  // Its Manhattan frame, or -1, and the axis (column of the rotation) along
  // which its normal lies exactly, or -1.
  int frame = -1;
  int axis = -1;
};

// A column or a pipe of the scene, detected by its outlines (OutlinePair): a
// straight circular cylinder along an axis of a Manhattan frame. World frame,
// units of the sparse model.
struct ModelCylinder {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // On its axis.
  AxisFrame frame;  // Along the cylinder, and across it.
  double radius = 1.0;
  // The visible range along its axis, relative to `point`.
  double min_height = 0.0;
  double max_height = 0.0;
  // Covariance of the shifts along frame.across and frame.Third(), and of the
  // radius.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

// The planes, columns and pipes of a whole scene, and the labels of every view.
struct SceneModel {
  std::vector<ModelPlane> planes;
  // Rotations whose columns are the axes, in the world frame.
  std::vector<Eigen::Matrix3d> frames;
  // Columns and pipes, grouped by axis.
  std::vector<ModelCylinder> cylinders;
  // Labels by image (index into the sparse model's images).
  std::map<int, ViewLabels> views;
};

}  // namespace tsar
