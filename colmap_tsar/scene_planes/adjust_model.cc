// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_model.h"

#include "colmap_tsar/scene_planes/angle_priors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// Beyond what rounding leaves.
bool IsAlongAxis(const ModelPlane& plane,
                 const std::vector<Eigen::Matrix3d>& frames) {
  return plane.frame >= 0 && frames[static_cast<size_t>(plane.frame)]
                                     .col(plane.axis)
                                     .cross(plane.plane.normal)
                                     .norm() < 1e-9;
}

// What is known of the adjusted plane, for one that is a little beside it.
void SetKnowledge(const AdjustedPlane& from, ModelPlane* plane) {
  plane->covariance = from.covariance;
  // Otherwise the middle is not amid what was measured.
  if (!std::isfinite(from.covariance(2, 2))) {
    return;
  }
  const Eigen::Vector3d& normal = plane->plane.normal;
  plane->center = from.center - plane->plane.Height(from.center) * normal;
  plane->axis_s = (from.axis_s - from.axis_s.dot(normal) * normal).normalized();
  plane->axis_t = normal.cross(plane->axis_s);
}

}  // namespace

void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model) {
  PlaneAdjustment adjustment;
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (!may_move[p] && !IsAlongAxis(plane, model->frames)) {
      plane.frame = plane.axis = -1;
    }
    adjustment.planes.push_back(plane.plane);
    adjustment.axes.push_back({plane.frame, plane.axis});
  }
  adjustment.frames = model->frames;
  adjustment.angles = FindAnglePriors(model->planes);
  AdjustPlanesOptions options;
  if (std::find(may_move.begin(), may_move.end(), true) == may_move.end()) {
    options.max_rounds = 1;  // Planes have to be measured once only.
  }
  const AdjustedPlanes adjusted = AdjustPlanes(adjustment, measure, options);
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (may_move[p]) {
      plane.plane = adjusted.planes[p].plane;
      if (plane.frame >= 0) {
        const auto frame = static_cast<size_t>(plane.frame);
        model->frames[frame] = adjusted.frames[frame];
      }
    }
    SetKnowledge(adjusted.planes[p], &plane);
  }
}

}  // namespace tsar
