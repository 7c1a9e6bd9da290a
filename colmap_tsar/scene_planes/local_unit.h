// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/adjust_planes.h"

#include <vector>

#include <Eigen/Core>

namespace tsar {

// A frame amid what is adjusted, parallel to the world's, in which lengths are
// about 1: far from the world's origin numbers would lose their last digits,
// and thresholds would depend on the unit of length.
struct LocalUnit {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double size = 1.0;  // Of the scene: the length that is 1; above 0.

  Eigen::Vector3d ToLocal(const Eigen::Vector3d& point) const;
  WorldPlane ToLocal(const WorldPlane& plane) const;
  PlaneMeasurement ToLocal(const PlaneMeasurement& measurement) const;
  Eigen::Vector3d ToWorld(const Eigen::Vector3d& point) const;
  WorldPlane ToWorld(const WorldPlane& plane) const;
};

// Amid the places where planes were measured, and from where, of points and of
// the cameras that see creases; of the size of their median distance from
// there, so that few that are far away do not matter. Where there are no two
// places, planes count by their point that is nearest to the origin. Throws
// std::invalid_argument where lengths are too large to be squared.
LocalUnit LocalUnitOf(const PlaneAdjustment& adjustment,
                      const std::vector<PlaneMeasurement>& measurements);

}  // namespace tsar
