// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/view_data.h"
#include "colmap_tsar/store/workspace.h"

namespace tsar {

// Reads image number `image` with all its evidence. Throws what the
// workspace's readers throw; kMismatch when two of its maps differ in size.
// distrust_untextured: see RefineOptions.
ViewData LoadView(const Workspace& workspace,
                  int image,
                  bool distrust_untextured = false);

}  // namespace tsar
