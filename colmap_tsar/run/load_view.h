// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/view_data.h"

namespace tsar {

// Reads image number `image` with all its evidence, of which there is none
// where the image is masked, and its depth prior. Throws what the workspace's
// readers throw; kMismatch when two of its maps differ in size.
ViewData LoadView(const Workspace& workspace, int image);

// The same at the size at which it is judged, or where max_side says else:
// ReduceView() of that view, of which a few rows are in memory at a time.
ViewData LoadReducedView(const Workspace& workspace,
                         int image,
                         int max_side = kMaxJudgingSide);

// Reads only the camera, the colours and the depths of the map to refine, which
// are 0 where the image is masked.
ViewData LoadDepthAndColor(const Workspace& workspace, int image);

// Whether the map to refine has depths, and all of them are masked.
bool IsMaskedAway(const Workspace& workspace, int image);

}  // namespace tsar
