// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/evidence/scene_model.h"

#include <Eigen/Geometry>

namespace tsar {

// A plane through a point, with axes in it; neither in a frame nor measured.
inline ModelPlane MakeModelPlane(const Eigen::Vector3d& normal,
                                 const Eigen::Vector3d& point) {
  ModelPlane plane;
  plane.plane.normal = normal.normalized();
  plane.plane.offset = -plane.plane.normal.dot(point);
  plane.center = point;
  plane.axis_s = plane.plane.normal.unitOrthogonal();
  plane.axis_t = plane.plane.normal.cross(plane.axis_s);
  return plane;
}

// Adds one that lies along an axis of the model's first frame. Its number.
inline int AddAlignedPlane(const Eigen::Vector3d& normal,
                           const Eigen::Vector3d& center,
                           int axis,
                           double support,
                           SceneModel* model) {
  ModelPlane plane = MakeModelPlane(normal, center);
  plane.frame = 0;
  plane.axis = axis;
  plane.support = support;
  model->planes.push_back(plane);
  return static_cast<int>(model->planes.size()) - 1;
}

// Three planes, one of which lies along an axis of a frame, a cylinder, and
// three views; the second one has no superpixels.
inline SceneModel MakeSceneModel() {
  SceneModel model;
  model.frames.push_back(
      Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized())
          .toRotationMatrix());
  model.planes = {MakeModelPlane({1, 2, 3}, {4, 5, 6}),
                  MakeModelPlane(model.frames[0].col(1), {-1, 0, 1e6}),
                  MakeModelPlane({0, 0, -1}, {0, 0, 2})};
  model.planes[0].covariance << 1, 2, 3, 2, 5, 6, 3, 6, 9;
  model.planes[0].support = 1234.5;
  model.planes[0].component = 2;
  model.planes[1].frame = 0;
  model.planes[1].axis = 1;
  ModelCylinder cylinder;
  cylinder.point = {1, -2, 3e5};
  cylinder.frame.along = model.frames[0].col(2);
  cylinder.frame.across = model.frames[0].col(0);
  cylinder.radius = 0.25;
  cylinder.min_height = -1.5;
  cylinder.max_height = 2.5;
  cylinder.covariance << 4, 1, 0, 1, 5, 2, 0, 2, 6;
  model.cylinders.push_back(cylinder);
  model.views[0] = {
      {0, -1, 2},
      {LabelOrigin::kMeasured, LabelOrigin::kNone, LabelOrigin::kCarried},
      std::vector<LabelQuality>(3)};
  model.views[0].qualities[2].margin = ByteOf<-1, 2>(0.5f);
  model.views[3] = {};
  model.views[7] = {{1}, {LabelOrigin::kGuessed}, std::vector<LabelQuality>(1)};
  return model;
}

}  // namespace tsar
