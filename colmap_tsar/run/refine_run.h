// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/refine_plan.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/scene_model_store.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/view_loader.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_options.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace tsar {

// The parts of a run over images. All outlive the objects they are passed to.
struct RefineRun {
  const WorkspaceRefineOptions& options;
  const RefineOptions& refine_options;
  Workspace& workspace;  // The one that is written.
  const WorkspaceOverview& overview;
  // Indices in Problems(), by shard; the run works on those of its own shard.
  const std::vector<std::vector<size_t>>& shards;
  const RefineDevices& devices;
  const InputFingerprints& inputs;
  EvidenceStore& evidence;
  const SceneModelStore& model;
  const RefinePlan& plan;
  ViewLoader& loader;

  const std::vector<size_t>& Images() const {
    return shards[options.shard.index];
  }
  // Whether some image of the run has yet to be refined and can be.
  bool IsAnyNeeded() const {
    return std::ranges::any_of(
        Images(), [&](size_t index) { return plan.IsToBeRefined(index); });
  }
  // The number of the run's images with a mask; nothing without masks.
  std::optional<int64_t> NumMasks() const {
    return workspace.CountMasks(workspace.ReferencesOf(Images()));
  }
  // The number of the run's images with a depth prior; nothing without priors.
  std::optional<int64_t> NumPriors() const {
    return workspace.Priors().Count(workspace.ReferencesOf(Images()));
  }
  bool IsShard() const { return options.pass != RefinePass::kAll; }
  bool HasScenePlanes() const { return NeedsEvidence(refine_options); }
};

}  // namespace tsar
