// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"
#include "colmap_tsar/controllers/refine_workspace.h"

#include <string>

namespace tsar {

// Adds the options by which a command is told where to compute and how much
// memory to take. group: what their names begin with, such as "TsarRefine.".
void AddDeviceOptions(const std::string& group,
                      WorkspaceRefineOptions* run,
                      OptionSet* options);

}  // namespace tsar
