// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/axis_frame.h"

#include <Eigen/Core>

namespace tsar {

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

}  // namespace tsar
