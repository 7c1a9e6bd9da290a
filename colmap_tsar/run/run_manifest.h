// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/run_summary.h"

#include <vector>

namespace tsar {

// The manifest of a run over all images, stereo/tsar/manifest.json, records its
// state for the user and later runs. Shards write none before they are merged.

// Called before any image is changed.
void BeginManifest(const RefineRun& run);

// Called when the last pass has ended or had to stop: then throws the failure
// of an image, or kInterrupted. When all images are done, the files that only
// an unfinished run needs are removed.
void FinishManifest(const RefineRun& run, const PipelineOutcome& outcome);

// The part of a summary about the inputs. references: of the images of the run.
RunSummary SummarizeInputs(const Workspace& workspace,
                           RefinePass pass,
                           const std::vector<int>& references);

// Ends the work of shards: writes the manifest of all images and removes the
// evidence. Opens no map. A second call changes nothing. Throws Error, and
// changes nothing: kNotFound, naming one, where images have not been composed
// with these options from what is there now; what WorkspaceLock throws, for
// example while a shard is at work.
RunSummary MergeShards(const WorkspaceRefineOptions& options,
                       const RefineOptions& refine_options);

}  // namespace tsar
