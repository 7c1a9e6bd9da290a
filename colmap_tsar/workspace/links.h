// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/originals.h"

#include <filesystem>

namespace tsar {

// Makes `link` a symbolic link to the canonical path of `target`, in one step,
// in the place of a file or link of that name. Creates the folder. Error kIo.
void ReplaceByLink(const std::filesystem::path& target,
                   const std::filesystem::path& link);

// Links one map of an output workspace to its original; where the input has no
// such map, removes what is there.
void LinkMap(OriginalState state,
             const std::filesystem::path& original,
             const std::filesystem::path& link);

}  // namespace tsar
