// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/surfaces/axis_camera.h"
#include "colmap_tsar/scene/surfaces/outline_edges.h"

#include <cstddef>
#include <vector>

namespace tsar {

// The outline pairs of a view along an axis.
struct OutlineView {
  AxisCamera camera;
  std::vector<OutlinePair> pairs;
};

// Lengths are in pixels of the views' rasters.
struct FindCylindersOptions {
  // The least number of views that show both outlines,
  size_t min_views = 4;
  // their largest residual,
  double max_difference = 1.3;
  // and the largest root mean square of residuals.
  double max_residual = 0.3;
  // The outlines of a cylinder are different lines of it in each view. Two
  // fixed lines, such as the edges of a board, must have a residual larger by
  // this factor, where residuals below the least are errors of edges.
  double min_ratio = 2.0;
  double least_residual = 0.125;
  // The least median of the widths in views, and the least length along the
  // axis that at least half of the views show.
  double min_width = 12.0;
  double min_length = 20.0;
};

// Finds circular cylinders along the axis of `frame` whose outlines are among
// the pairs of several views. neighbors: by view, other views of the same
// surfaces. Of cylinders that intersect at the same heights, one remains. The
// result does not depend on the number of threads.
std::vector<ModelCylinder> FindCylinders(
    const std::vector<OutlineView>& views,
    const std::vector<std::vector<size_t>>& neighbors,
    const AxisFrame& frame,
    const FindCylindersOptions& options,
    ThreadPool& threads);

}  // namespace tsar
