// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/memory_plan.h"
#include "colmap_tsar/controllers/workspace_check.h"
#include "colmap_tsar/stereo/stereo_options.h"

namespace tsar {

// What tsar_stereo takes of the memories. overview: of the maps to make.
MemoryPlan PlanStereo(const StereoOptions& options,
                      const WorkspaceOverview& overview);

}  // namespace tsar
