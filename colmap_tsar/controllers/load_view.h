// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/view_data.h"
#include "colmap_tsar/store/workspace.h"

namespace tsar {

// Reads image number `image` with all its evidence. Throws what the
// workspace's readers throw; kMismatch when two of its maps differ in size.
ViewData LoadView(const Workspace& workspace, int image);

// Reads only the camera, the colours and the depths of the map to refine.
ViewData LoadDepthAndColor(const Workspace& workspace, int image);

// See pipeline/unmatched_depths.h. A view does not tell: it lacks the depths
// that have no normal, as isolated ones where normals follow from depth.
bool IsUnfiltered(const Workspace& workspace, int image);

}  // namespace tsar
