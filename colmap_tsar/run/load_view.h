// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/view_data.h"

namespace tsar {

// Reads the image with index `image`, its hypotheses and its depth prior,
// without what is masked. Throws what the workspace's readers throw; kMismatch
// when two of its maps differ in size.
ViewData LoadView(const Workspace& workspace, int image);

// ReduceView() of LoadView(), to a long side of at most max_side, with only a
// few rows of the full view in memory at a time.
ViewData LoadReducedView(const Workspace& workspace,
                         int image,
                         int max_side = kMaxJudgingSide);

// Whether the map to refine has depths, and all of them are masked.
bool IsMaskedAway(const Workspace& workspace, int image);

}  // namespace tsar
