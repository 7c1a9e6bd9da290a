// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

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

}  // namespace tsar
