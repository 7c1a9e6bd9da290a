// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/controllers/run_summary.h"
#include "colmap_tsar/pipeline/refine_options.h"

namespace tsar {

// Ends the work of shards: writes the account of all images (manifest.json),
// and removes the evidence and the shards' own records. Opens no map. Where
// there are no shards because they were merged before, it only makes sure that
// nothing is left of them.
//
// Throws Error, and changes nothing: kNotFound, naming them, where shards or
// images have not been composed; kMismatch where the shards were run with other
// options; what WorkspaceLock throws, while a shard is at work for one.
RunSummary MergeShards(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options);

}  // namespace tsar
