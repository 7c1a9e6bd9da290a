// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <string>
#include <vector>

namespace tsar {

// For programs that read the files that refinement writes beside the maps, of
// the workspace's type: gives one warning about files that are missing or
// differ from their images' records. names: of ResultFiles(); empty: all.
// Throws what ReadRecord and HashFile throw, except for corrupt records, which
// are another warning.
void WarnOfChangedResults(const Workspace& workspace,
                          const std::vector<std::string>& names = {});

}  // namespace tsar
