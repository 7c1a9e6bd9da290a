// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The camera of a view rectified for an axis: rotated about its center so that
// the columns of its image are parallel to the axis and each is a direction in
// the plane across the axis. Pixels are about the size of those of the view's
// raster.
struct AxisCamera {
  Camera view;  // Of the view's raster.
  int width = 0;
  int height = 0;
  double focal = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  // The camera center and unit vectors, in the plane across the axis, in units
  // of the model.
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::UnitX();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitY();
  double center_height = 0.0;
  // Rotation from a ray of this camera, ((x - cx) / focal, (y - cy) / focal,
  // 1), to one in the view's camera frame.
  Eigen::Matrix3d to_view = Eigen::Matrix3d::Identity();

  // The direction of a column; not of unit length.
  Eigen::Vector2d Direction(double column) const {
    return forward + (column - cx) / focal * right;
  }
  // The height of a row at a distance along `forward`.
  double Height(double row, double distance) const {
    return center_height + (row - cy) / focal * distance;
  }
};

// The rectified camera; camera: of the raster. Nothing where the optical axis
// is nearly parallel to the axis, or the focal lengths differ so much that the
// rectified image would be many times as large as the raster.
std::optional<AxisCamera> MakeAxisCamera(const Camera& camera,
                                         const AxisFrame& frame);

// The cross section of a cylinder along an axis.
struct AxisCircle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

// The outlines of a circle in a camera.
struct CircleOutline {
  double left = 0.0;  // Columns.
  double right = 0.0;
  // Distances, along the camera's forward direction, of the points at which the
  // rays of these columns touch the circle.
  double left_distance = 0.0;
  double right_distance = 0.0;

  double MeanDistance() const { return 0.5 * (left_distance + right_distance); }
};

// The outlines; nothing where the camera is in the circle or close to it, or
// the circle is not in front of the camera.
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

// Fits a circle by least squares of its distances from the tangents, each in
// units of a pixel at the point where it touches `near`; without `near`, in
// units of the model. covariance: of center and radius, for errors of tangents
// of one pixel; may be null. Nothing where the tangents do not determine it.
std::optional<AxisCircle> FitCircle(const std::vector<CircleTangent>& tangents,
                                    const AxisCircle* near,
                                    Eigen::Matrix3d* covariance);

// The point that is nearest to all the columns' rays; nothing where these do
// not determine it.
std::optional<Eigen::Vector2d> FitPoint(
    const std::vector<CircleTangent>& tangents);

}  // namespace tsar
