// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/view/refine_options.h"

#include <functional>

namespace tsar {

// Finds the planes of the scene for all shards, once these are observed. Does
// nothing where it was done before, where images are refined each on its own,
// and where no image is left to be refined. Throws Error: kNotFound, naming it,
// where an image has not been observed with these options, or an input has
// changed since; kInterrupted; what reading the files throws.
RunSummary ModelShards(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options,
                       Progress& progress,
                       const std::function<bool()>& should_stop);

// Ends the work of shards: writes the account of all images (manifest.json) and
// removes the evidence. Opens no map. Once more, it changes nothing.
//
// Throws Error, and changes nothing: kNotFound, naming one, where images have
// not been composed with these options from what is there now; what
// WorkspaceLock throws, for example while a shard is at work.
RunSummary MergeShards(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options);

}  // namespace tsar
