// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/tools/report/point_sample.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A pose of the 3D view, relative to the points' origin.
struct Viewpoint {
  Eigen::Vector3d eye;
  Eigen::Vector3d target;  // The view turns about it.
};

// The pose of the camera that sees most of the scene: the largest part of the
// volume elements that hold points, behind no other points. Neither a camera
// that faces a wall at arm's length nor one with a wall before it is chosen,
// however many points are there. The target lies on the camera's axis at the
// median depth of what it sees. Nothing where no camera sees a point. origin:
// of the points.
std::optional<Viewpoint> ChooseViewpoint(const std::vector<Camera>& cameras,
                                         const PointSample& points,
                                         const Eigen::Vector3d& origin);

}  // namespace tsar
