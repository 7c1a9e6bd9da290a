// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/workspace.h"

namespace tsar {

// Opens the workspace with the requested type of maps, or the type that it has.
Workspace OpenWorkspace(const WorkspaceRefineOptions& options);

}  // namespace tsar
