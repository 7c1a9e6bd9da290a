// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace tsar {

// Makes a second workspace in `output` that stereo_fusion can use, and opens
// it: images and sparse model are links to the input's, the configuration files
// copies, and every map a link to the input's original until WriteBack replaces
// it by a file. The input is not changed.
//
// A folder that an earlier call made for the same input is reused, with the
// maps that were refined there. Throws Error: kUnsupported (output is the
// input, inside its stereo folder or around it; or not empty and not made by
// this program), kIo.
Workspace CreateOutputWorkspace(const Workspace& input,
                                const std::filesystem::path& output,
                                MapType type);

// The folder in stereo/tsar where an input records the output workspaces whose
// links lead to its originals.
inline constexpr const char* kOutputsFolder = "outputs";

// The links of output workspaces lead to the originals of their input, which
// move when its maps are refined or restored in place. Renews the links in all
// output workspaces that CreateOutputWorkspace recorded in this input, and
// returns their paths. Changes only links to originals of this input, in
// workspaces whose marker names it; warns where a workspace is in use. The
// caller holds the WorkspaceLock of the input. all_done: set to false where an
// output could not be checked or changed.
std::vector<std::filesystem::path> RelinkOutputs(
    const std::filesystem::path& input, bool* all_done);

// The input of a workspace that CreateOutputWorkspace made; nothing for others.
std::optional<std::filesystem::path> ReadOutputMarker(
    const std::filesystem::path& root);

}  // namespace tsar
