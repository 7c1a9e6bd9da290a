// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene_planes/axis_frame.h"

#include <optional>

#include <Eigen/Core>

namespace tsar {

// The camera of a view that is rectified for an axis: turned about its centre
// until the columns of its image are parallel to the axis, each of which is
// then a direction in the plane across the axis. Pixels are about those of the
// view's raster.
struct AxisCamera {
  int width = 0;
  int height = 0;
  double focal = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  // In the plane across the axis, units of the model: where the camera is, and
  // unit vectors.
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitY();
  double center_height = 0.0;
  // From a ray of this camera, ((x - cx) / focal, (y - cy) / focal, 1), to one
  // in the view's camera frame.
  Eigen::Matrix3d to_view = Eigen::Matrix3d::Identity();

  // Along a column; not of unit length.
  Eigen::Vector2d Direction(double column) const {
    return forward + (column - cx) / focal * right;
  }
  // The height that a row shows at a distance along `forward`.
  double Height(double row, double distance) const {
    return center_height + (row - cy) / focal * distance;
  }
};

// camera: of the raster. Nothing where the camera looks along the axis, or
// nearly so, or where its focal lengths differ so much that the rectified image
// would be many times as large as the raster.
std::optional<AxisCamera> MakeAxisCamera(const Camera& camera,
                                         const AxisFrame& frame);

}  // namespace tsar
