// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"

namespace tsar {

// The memory plan of tsar_stereo. overview: that of the maps to make.
MemoryPlan PlanStereo(const StereoOptions& options,
                      const WorkspaceOverview& overview);

}  // namespace tsar
