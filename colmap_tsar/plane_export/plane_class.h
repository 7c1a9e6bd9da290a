// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

enum class PlaneClass { kFloor, kCeiling, kWall, kOther };

// "floor", "ceiling", "wall" or "other".
std::string ToString(PlaneClass of_plane);

// Which way is up, and who says so.
struct Vertical {
  enum class Source {
    kFrame,    // The axis of a Manhattan frame that the cameras come nearest.
    kCameras,  // The mean of the cameras' own up, with no axis near it.
    kNone,     // The cameras look all ways, and nothing is known.
  };
  Eigen::Vector3d up = Eigen::Vector3d::Zero();  // Of unit length, or 0.
  Source source = Source::kNone;
};

// "manhattan_frame", "cameras" or "none".
std::string ToString(Vertical::Source source);

// camera_ups: unit vectors in the world frame (-y of each camera). frames: see
// SceneModel.
Vertical FindVertical(const std::vector<Eigen::Vector3d>& camera_ups,
                      const std::vector<Eigen::Matrix3d>& frames);

// Floor and ceiling: the normal within 15 degrees of the vertical, and most of
// the cameras that see it above or below. Wall: the normal within 15 degrees of
// horizontal. All else, and all where there is no vertical, is other.
// point: of the plane; cameras: the centres of those that see it.
PlaneClass ClassifyPlane(const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& point,
                         const std::vector<Eigen::Vector3d>& cameras,
                         const Vertical& vertical);

}  // namespace tsar
