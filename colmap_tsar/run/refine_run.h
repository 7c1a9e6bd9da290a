// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/image_selection.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/pipeline_devices.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_options.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace tsar {

// A run over the images of a shard; a run over all images has shard 0 of 1. All
// references outlive the objects that get them.
struct RefineRun {
  const WorkspaceRefineOptions& options;
  const RefineOptions& refine_options;
  Progress& progress;
  const Workspace& workspace;  // The one that is written.
  const WorkspaceOverview& overview;
  const std::vector<size_t>& images;  // Of the shard, as in Problems().
  const PipelineDevices& devices;
  const InputFingerprints& inputs;
  const ImageSelection& selection;
  EvidenceStore& evidence;

  // Whether some image of the run has yet to be refined and can be.
  bool IsAnyNeeded() const {
    return std::ranges::any_of(
        images, [&](size_t index) { return selection.IsToBeRefined(index); });
  }
  bool HasScenePlanes() const { return NeedsEvidence(refine_options); }
  // Whether the planes of the scene, with the labels of all views, are those of
  // these options and inputs.
  bool HasCurrentPlanes() const;
};

}  // namespace tsar
