// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/shard_passes.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/refine_plan.h"
#include "colmap_tsar/run/scene_model_store.h"
#include "colmap_tsar/run/shard.h"
#include "colmap_tsar/run/shard_entries.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {
namespace {

void Model(const WorkspaceRefineOptions& options,
           const RefineOptions& refine_options,
           const Workspace& workspace,
           Progress& progress,
           const std::function<bool()>& should_stop) {
  // Without any record, the error message names the first shard.
  const Shard shards = {
      0,
      std::max(1, CountShards(workspace, refine_options, RefinePass::kModel))};
  const InputFingerprints inputs(workspace);
  ShardRecord own =
      DescribeShard(workspace, refine_options, RefinePass::kModel, shards);
  own.inputs = inputs.OfRun();
  const ObservedShards observed =
      ReadObservedShards(workspace, own, SplitImages(workspace, shards.count));
  if (!NeedsEvidence(refine_options)) {
    return;
  }
  const WorkspaceOverview overview = CheckWorkspace(workspace);
  const MemoryPlan memory = PlanRefinement(refine_options, overview);
  ModelResources resources = PlanModelPass(options.devices, memory);
  const std::string options_hash = HashRefineOptions(refine_options);
  const SceneModelStore store(workspace, inputs, options_hash);
  RefinePlan plan(workspace,
                  inputs,
                  overview.has_maps,
                  FindListedImages(workspace, {}),
                  options_hash,
                  store.PlanesFingerprint(),
                  /*reuses_results=*/true);
  if (store.IsCurrent() || !plan.IsAnyNeeded()) {
    return;
  }
  EvidenceStore evidence(
      workspace,
      inputs,
      options_hash,
      NumEvidenceViews(overview, static_cast<size_t>(resources.num_views)));
  evidence.Expect(observed.with_evidence);
  for (size_t index = 0; index < plan.NumImages(); ++index) {
    RequireObserved(workspace, plan.Reference(index), observed);
  }
  // A GPU too small for observing or composing may suffice here.
  const std::vector<GpuWorkers> gpus =
      OpenGpus(options.devices,
               ForLabelsAlone(memory),
               static_cast<int>(plan.NumImages()),
               GpuSystem::Cuda());
  AddGpus(gpus, memory, &resources);
  if (!ModelWorkspace({workspace, plan, evidence, store, refine_options},
                      resources,
                      "Scene model,",
                      progress,
                      should_stop)) {
    throw Error(ErrorCode::kInterrupted,
                "interrupted before the planes of the scene were found; run "
                "the same command again");
  }
}

std::map<std::string, std::string> RuntimeOfShards(
    const std::vector<ShardRecord>& shards) {
  std::map<std::string, std::string> runtime = {
      {"shards", std::to_string(shards.size())}};
  for (const ShardRecord& shard : shards) {
    const std::string name =
        "shard " + ToString(Shard{shard.index, shard.count});
    for (const auto& [key, value] : shard.runtime) {
      runtime[name + ", " + key] = value;
    }
  }
  return runtime;
}

// The sum of num_masks or num_priors over the records of the shards, whatever
// the options of the merge.
std::optional<int64_t> SumOfShards(const std::vector<ShardRecord>& shards,
                                   std::optional<int64_t> ShardRecord::*count) {
  std::optional<int64_t> sum;
  for (const ShardRecord& shard : shards) {
    if (shard.*count) {
      sum = sum.value_or(0) + *(shard.*count);
    }
  }
  return sum;
}

void RequireAllDone(const Workspace& workspace, const Manifest& manifest) {
  const int num_done = manifest.NumImages(ImageStatus::kDone) +
                       manifest.NumImages(ImageStatus::kKept);
  if (num_done < static_cast<int>(manifest.images.size())) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        std::to_string(manifest.images.size() - static_cast<size_t>(num_done)) +
            " of " + std::to_string(manifest.images.size()) +
            " images have not been refined with these options",
        "run " + OptionName("pass") +
            " observe of all shards, model, and compose of all shards first");
  }
}

}  // namespace

RunSummary ModelShards(const WorkspaceRefineOptions& options,
                       const RefineOptions& refine_options,
                       Progress& progress,
                       const std::function<bool()>& should_stop) {
  const Stopwatch stopwatch;
  const OpenCvWithoutThreads opencv_without_threads;
  const Workspace workspace = OpenWorkspace(options);
  const WorkspaceLock lock(workspace.Root());
  Model(options, refine_options, workspace, progress, should_stop);
  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.type = workspace.Type();
  summary.pass = RefinePass::kModel;
  summary.num_images = static_cast<int>(workspace.Problems().size());
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

RunSummary MergeShards(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options) {
  const Stopwatch stopwatch;
  const Workspace workspace = OpenWorkspace(workspace_options);
  const WorkspaceLock lock(workspace.Root());
  std::vector<ShardRecord> shards;
  if (const int count =
          CountShards(workspace, refine_options, RefinePass::kMerge);
      count > 0) {
    shards = ReadCompleteShards(
        workspace.Root(),
        DescribeShard(
            workspace, refine_options, RefinePass::kMerge, {0, count}),
        RefinePass::kCompose);
  }
  Manifest manifest = BuildManifest(workspace,
                                    RefineOptionsText(refine_options),
                                    HashRefineOptions(refine_options));
  RequireAllDone(workspace, manifest);
  const std::optional<int64_t> num_masks =
      SumOfShards(shards, &ShardRecord::num_masks);
  const std::optional<int64_t> num_priors =
      SumOfShards(shards, &ShardRecord::num_priors);
  if (!shards.empty()) {
    manifest.runtime = RuntimeOfShards(shards);
    manifest.inputs = InputFingerprints(workspace).States();
    NoteMasksAndPriors(num_masks, num_priors, &manifest);
    WriteManifest(workspace, manifest);
  }
  EvidenceStore::Clear(workspace);
  SceneModelStore::DropLabels(workspace);
  // The records go last: until then, the same call does all of it again.
  RemoveShardRecords(workspace.Root());

  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.model_folder = workspace.ModelFolder();
  summary.type = workspace.Type();
  summary.pass = RefinePass::kMerge;
  summary.num_images = static_cast<int>(manifest.images.size());
  summary.num_refined = manifest.NumImages(ImageStatus::kDone);
  summary.num_masks = num_masks;
  summary.num_priors = num_priors;
  for (const Manifest::Entry& entry : manifest.images) {
    if (entry.status == ImageStatus::kKept) {
      summary.kept.push_back({entry.image, entry.note});
    }
  }
  summary.counts = manifest.counts;
  summary.seconds = manifest.seconds;
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

}  // namespace tsar
