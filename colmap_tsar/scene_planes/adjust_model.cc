// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_model.h"

#include "colmap_tsar/scene_planes/angle_priors.h"

#include <cmath>
#include <cstddef>

namespace tsar {

void AdjustModel(const MeasurePlanes& measure, SceneModel* model) {
  PlaneAdjustment adjustment;
  for (const ModelPlane& plane : model->planes) {
    adjustment.planes.push_back(plane.plane);
    adjustment.axes.push_back({plane.frame, plane.axis});
  }
  adjustment.frames = model->frames;
  adjustment.angles = FindAnglePriors(model->planes);
  const AdjustedPlanes adjusted = AdjustPlanes(adjustment, measure);
  for (size_t p = 0; p < model->planes.size(); ++p) {
    const AdjustedPlane& from = adjusted.planes[p];
    ModelPlane& plane = model->planes[p];
    plane.plane = from.plane;
    plane.covariance = from.covariance;
    // Otherwise the middle is not amid what was measured.
    if (std::isfinite(from.covariance(2, 2))) {
      plane.center = from.center;
      plane.axis_s = from.axis_s;
      plane.axis_t = from.axis_t;
    }
  }
  model->frames = adjusted.frames;
}

}  // namespace tsar
