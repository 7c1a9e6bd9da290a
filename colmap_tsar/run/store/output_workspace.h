// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <filesystem>

namespace tsar {

// Makes the folder of an output workspace, so that it can be locked. Throws
// Error: kUnsupported (it is the input, inside one of its folders or around it;
// or it is not empty and was not made for this input), kIo.
void BeginOutputWorkspace(const Workspace& input,
                          const std::filesystem::path& output);

// Makes a second workspace in `output` that stereo_fusion can use, and opens
// it, with the input's masks and depth priors: images, sparse model and maps
// are links to the input's, the maps to its originals, and the configuration
// files copies. The input is not changed. From then on it is a workspace like
// any other.
//
// A folder that an earlier call made for the same input is reused, with the
// maps that were refined there; an original of the input that has changed since
// replaces its former version. Throws Error: what BeginOutputWorkspace and
// FindOriginals throw, kIo.
Workspace CreateOutputWorkspace(const Workspace& input,
                                const std::filesystem::path& output);

}  // namespace tsar
