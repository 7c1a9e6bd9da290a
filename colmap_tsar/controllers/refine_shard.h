// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/controllers/run_summary.h"
#include "colmap_tsar/pipeline/refine_options.h"

#include <functional>

namespace tsar {

// Works on one shard of a workspace's images, in one of the two passes, while
// other programs, perhaps on other machines, work on others: see SplitImages.
// No file has two writers. The pass observe writes evidence alone; where images
// are refined by themselves, it stores their originals instead. The pass
// compose reads the maps of its own images and the evidence of all, which all
// shards must have observed before; it leaves the same files as RefineWorkspace
// without shards. Each pass writes a ShardRecord.
//
// Throws Error as RefineWorkspace does, and before a file of the images is
// changed: kMismatch where other shards were run with other options, or where
// what was observed has changed since; kNotFound where shards have not been
// observed; kUnsupported where another program works on the shard or one is at
// the other pass. Whatever is thrown, the same call goes on.
RunSummary RefineShard(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options,
                       Progress& progress,
                       const std::function<bool()>& should_stop);

}  // namespace tsar
