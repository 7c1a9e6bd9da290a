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

// Finds circular cylinders along the axis of `frame` whose outlines are among
// the pairs of several views. neighbors: by view, other views of the same
// surfaces. Of cylinders that intersect at the same heights, one remains. The
// result does not depend on the number of threads.
std::vector<ModelCylinder> FindCylinders(
    const std::vector<OutlineView>& views,
    const std::vector<std::vector<size_t>>& neighbors,
    const AxisFrame& frame,
    ThreadPool& threads);

}  // namespace tsar
