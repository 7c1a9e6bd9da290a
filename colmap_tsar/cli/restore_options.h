// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/cli/option_set.h"

#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What the commands share that undo their work on a workspace.

// Adds --restore_conflicts.
void AddRestoreConflicts(std::string* value, OptionSet* options);

// Prints which maps were left as they are and where those are now that stood in
// the way. Throws Error kMismatch, after that, where images are left that the
// user has to decide about.
void ReportRestored(const std::vector<std::filesystem::path>& kept,
                    const std::vector<std::filesystem::path>& superseded,
                    const std::vector<std::filesystem::path>& conflicts);

// Throws Error kMismatch where refined maps have lost their originals.
void RequireNoneLost(const std::vector<std::filesystem::path>& lost);

}  // namespace tsar
