// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <optional>
#include <vector>

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

// A cylinder along an axis, as the plane across the axis cuts it.
struct AxisCircle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

// Where a camera sees the outlines of a circle.
struct CircleOutline {
  double left = 0.0;  // Columns.
  double right = 0.0;
  // Of the points at which the rays of these columns touch the circle, along
  // the camera's forward direction.
  double left_distance = 0.0;
  double right_distance = 0.0;
};

// Nothing where the camera is in the circle or close to it, or where the circle
// is not before the camera.
std::optional<CircleOutline> OutlineOf(const AxisCircle& circle,
                                       const AxisCamera& camera);

// Two columns of a camera between which it may show a circle.
struct ColumnPair {
  const AxisCamera& camera;
  double left;
  double right;
};

// Whether two cameras may show the same circle: a rough test that costs little.
bool MayShowOneCircle(const ColumnPair& a, const ColumnPair& b);

// A column of a camera that touches a circle.
struct CircleTangent {
  const AxisCamera* camera = nullptr;
  double column = 0.0;
  bool is_left = false;  // The circle is on its right.
};

// Least squares of the distances from the tangents, each in units of what one
// pixel spans where it touches `near`; without `near`, in units of the model.
// covariance: of centre and radius, for tangents that are wrong by one pixel;
// may be null. Nothing where the tangents do not tell.
std::optional<AxisCircle> FitCircle(const std::vector<CircleTangent>& tangents,
                                    const AxisCircle* near,
                                    Eigen::Matrix3d* covariance);

// The point that is nearest to all the columns' rays; nothing where these do
// not tell.
std::optional<Eigen::Vector2d> FitPoint(
    const std::vector<CircleTangent>& tangents);

}  // namespace tsar
