// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/originals.h"

#include <filesystem>

namespace tsar {

// Atomically makes `link` a symbolic link to the canonical path of `target`,
// replacing a file or link of that name. Creates the folder. Error kIo.
void ReplaceByLink(const std::filesystem::path& target,
                   const ContainedPath& link);

// Links one map of an output workspace to its original; where the input has no
// such map, removes an existing one.
void LinkMap(const OriginalMap& original, const ContainedPath& link);

// Throws Error kUnsupported where a folder of `stereo`, or `stereo` itself, is
// a link that leads out of the workspace: files there belong to somebody else.
// Folders are opened as folder.h describes, which protects them, but this check
// comes before anything is changed. Folders that are never written to may be
// such links: consistency_graphs and, in an output workspace, cost_maps. Links
// that are files are replaced, never written through. Throws kIo where a folder
// cannot be listed.
void RequireFoldersInside(const std::filesystem::path& root);

}  // namespace tsar
