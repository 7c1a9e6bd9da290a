// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <string>
#include <vector>

namespace tsar {

// For programs that read what refinements left beside the maps, of the type of
// the workspace: warns in one line of files that are gone, or that are not what
// the records of their images tell of. names: of ResultFiles(); empty: all.
// Throws what ReadRecord and HashFile throw, but for records that are none,
// which are another warning.
void WarnOfChangedResults(const Workspace& workspace,
                          const std::vector<std::string>& names = {});

}  // namespace tsar
