// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/failure.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/gpu_indices.h"
#include "colmap_tsar/controllers/image_pipeline.h"
#include "colmap_tsar/controllers/image_runner.h"
#include "colmap_tsar/controllers/input_fingerprints.h"
#include "colmap_tsar/controllers/memory_plan.h"
#include "colmap_tsar/controllers/merge_shards.h"
#include "colmap_tsar/controllers/observe_runner.h"
#include "colmap_tsar/controllers/refine_devices.h"
#include "colmap_tsar/controllers/refine_setup.h"
#include "colmap_tsar/controllers/refine_shard.h"
#include "colmap_tsar/controllers/shard.h"
#include "colmap_tsar/controllers/workspace_check.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/store/manifest.h"
#include "colmap_tsar/store/output_workspace.h"
#include "colmap_tsar/store/shard_record.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <chrono>
#include <exception>
#include <optional>
#include <string>

namespace tsar {
namespace {

bool WasRefinedBefore(ImageRunner& runner, size_t index) {
  try {
    return runner.HasBeenRefined(index);
  } catch (const Error&) {
    // That it cannot be found out may be what failed.
    return false;
  }
}

void MarkFailures(const ImagePipeline& pipeline,
                  ImageRunner& runner,
                  Manifest* manifest) {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!pipeline.Failures()[i]) {
      continue;
    }
    Manifest::Entry& entry = manifest->images[i];
    entry.note = FailureText(pipeline.Failures()[i]);
    if (WasRefinedBefore(runner, i)) {
      // It was only to be observed, and its maps are as good as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

}  // namespace

void WorkspaceRefineOptions::Check() const {
  const auto require = [](bool condition, const std::string& message) {
    if (!condition) {
      throw Error(ErrorCode::kBadOption, message);
    }
  };
  require(!workspace_path.empty(),
          OptionName("workspace_path") + " is missing; give it");
  require(device == "auto" || device == "cuda" || device == "cpu",
          OptionName("device") + ": not known; give auto, cuda or cpu");
  ParseGpuIndices(gpu_index);
  require(num_threads == -1 || num_threads > 0,
          OptionName("num_threads") + ": give at least 1, or -1 for all cores");
  require(cache_size > 0.0 && cache_size <= 1e6,
          OptionName("cache_size") + ": give a positive number of gigabytes");
  const RefinePass chosen = ParsePass(pass);
  require(chosen != RefinePass::kAll || ParseShard(shard).count == 1,
          OptionName("shard") +
              ": a part of the images needs what is observed in the "
              "others; run " +
              OptionName("pass") +
              " observe for all shards, then compose for "
              "all, then merge");
  require(chosen != RefinePass::kMerge || shard.empty(),
          OptionName("shard") + ": " + OptionName("pass") +
              " merge is for all shards together; "
              "leave it out");
  require(
      chosen == RefinePass::kAll || output_path.empty(),
      OptionName("output_path") +
          ": shards refine in place; leave it out, and make a copy "
          "of links first (cp -as) where the workspace is to stay as it is");
}

RunSummary RefineWorkspace(const WorkspaceRefineOptions& workspace_options,
                           const RefineOptions& refine_options,
                           Progress& progress,
                           const std::function<bool()>& should_stop,
                           RefineObserver* observer) {
  workspace_options.Check();
  refine_options.Check();
  switch (ParsePass(workspace_options.pass)) {
    case RefinePass::kAll:
      break;
    case RefinePass::kObserve:
    case RefinePass::kCompose:
      return RefineShard(
          workspace_options, refine_options, progress, should_stop);
    case RefinePass::kMerge:
      return MergeShards(workspace_options, refine_options);
  }
  const OpenCvWithoutThreads opencv_without_threads;
  const auto start = std::chrono::steady_clock::now();
  Workspace workspace = OpenWorkspace(workspace_options);
  std::optional<WorkspaceLock> lock;
  std::optional<WorkspaceLock> input_lock;
  const bool in_place = workspace_options.output_path.empty();
  if (in_place) {
    lock.emplace(workspace.Root());
  }
  if (!in_place || workspace.IsOutput()) {
    // So that nobody changes the originals while they are read.
    input_lock.emplace(workspace.SourceRoot(),
                       workspace.IsOutput()
                           ? WorkspaceLock::Mode::kSharedIfThere
                           : WorkspaceLock::Mode::kShared);
  }
  const WorkspaceOverview overview = CheckWorkspace(workspace);
  CheckOriginals(workspace);
  RefineDevices devices = CreateRefineDevices(
      workspace_options,
      overview,
      [&](const WorkspaceOverview& maps) {
        return PlanRefinement(refine_options, maps);
      },
      static_cast<int>(workspace.Problems().size()));
  if (!in_place) {
    if (ReadOutputMarker(workspace_options.output_path)) {
      // Another program may be at work on it.
      lock.emplace(workspace_options.output_path);
    }
    workspace = CreateOutputWorkspace(
        workspace, workspace_options.output_path, workspace.Type());
    if (!lock) {
      lock.emplace(workspace.Root());
    }
  }

  const auto build_manifest = [&] {
    Manifest manifest = BuildManifest(workspace,
                                      RefineOptionsText(refine_options),
                                      HashRefineOptions(refine_options));
    manifest.runtime = RuntimeText(workspace_options, devices);
    return manifest;
  };
  WriteManifest(workspace, build_manifest());

  const bool has_scene = refine_options.scene_planes && refine_options.refine;
  InputFingerprints inputs(workspace, has_scene);
  std::optional<EvidenceStore> evidence;
  if (has_scene) {
    evidence.emplace(workspace,
                     inputs,
                     HashRefineOptions(refine_options),
                     NumEvidenceViews(overview, devices.workers.size()));
  }
  ImageRunner runner(workspace,
                     overview.has_maps,
                     refine_options,
                     devices.workers,
                     inputs,
                     evidence ? &*evidence : nullptr,
                     devices.finds_scenes_ahead,
                     observer);
  ViewCache cache(devices.cache_num_bytes,
                  static_cast<size_t>(ViewBytes(overview)),
                  [&](int image) { return runner.Load(image); });
  std::optional<ObserveRunner> first_pass;
  std::optional<ImagePipeline> observing;
  if (evidence) {
    first_pass.emplace(runner, *evidence);
    observing.emplace(*first_pass, cache, devices.sizes, progress, should_stop);
    observing->Run(devices.workers.size());
  }
  ImagePipeline refining(runner, cache, devices.sizes, progress, should_stop);
  // A view whose neighbours were not all observed would get another map.
  const bool has_observed = !observing || IsComplete(*observing);
  if (has_observed) {
    refining.Run(devices.workers.size());
  }
  const ImagePipeline& pipeline = has_observed ? refining : *observing;

  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.type = workspace.Type();
  summary.device = devices.description;
  summary.num_workers = static_cast<int>(devices.workers.size());
  summary.peak_gpu_memory = PeakGpuMemory(devices);
  summary.num_images = static_cast<int>(workspace.Problems().size());
  for (size_t i = 0; i < refining.Reports().size(); ++i) {
    const int image = workspace.Problems()[i].reference;
    summary.Add(workspace.Model().images[static_cast<size_t>(image)].name,
                refining.Reports()[i]);
  }
  summary.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  Manifest manifest = build_manifest();
  MarkFailures(pipeline, runner, &manifest);
  try {
    WriteManifest(workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image says more.
    RethrowFailure(pipeline);
    throw;
  }
  RethrowFailure(pipeline);
  const int num_done = summary.num_refined + summary.num_skipped +
                       static_cast<int>(summary.kept.size());
  if (num_done < summary.num_images) {
    throw Interrupted(num_done, summary.num_images);
  }
  // Also what a run with other options left behind.
  EvidenceStore::Clear(workspace);
  RemoveShardRecords(workspace.Root());
  if (in_place && !workspace.IsOutput()) {
    // Images that keep their maps have got them back from where links lead.
    bool are_all_linked = true;
    RelinkOutputs(workspace.Root(), &are_all_linked);
  }
  return summary;
}

}  // namespace tsar
