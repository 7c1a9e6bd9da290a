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

// What a view shows along an axis.
struct OutlineView {
  AxisCamera camera;
  std::vector<OutlinePair> pairs;
};

// Lengths are in pixels of the views' rasters.
struct FindCylindersOptions {
  // At least so many views show both outlines,
  size_t min_views = 4;
  // this far from where they are expected at most,
  double max_difference = 1.3;
  // and in the root mean square.
  double max_residual = 0.3;
  // The outlines of a cylinder are at another place of it in each view. Two
  // lines that stay where they are, such as the edges of a board, must explain
  // them so many times worse, where residuals below the least are errors of
  // edges.
  double min_ratio = 2.0;
  double least_residual = 0.125;
  // The median of the views' widths, and the part along the axis that at least
  // half of the views show, are no less than this.
  double min_width = 12.0;
  double min_length = 20.0;
};

// Circular cylinders along the axis of `frame` whose outlines are among the
// pairs of several views. neighbours: by view, the others that look at the same
// things. Of cylinders that are in each other at the same heights, one remains.
// The same for any number of threads.
std::vector<ModelCylinder> FindCylinders(
    const std::vector<OutlineView>& views,
    const std::vector<std::vector<size_t>>& neighbours,
    const AxisFrame& frame,
    const FindCylindersOptions& options,
    ThreadPool& threads);

}  // namespace tsar
