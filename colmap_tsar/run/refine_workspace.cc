// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/run/refine_passes.h"
#include "colmap_tsar/run/run_manifest.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// name: for the user. num_pixels: of the largest view.
PipelineOutcome RunPass(const RefineRun& run,
                        ImagePass<RefineResult>& pass,
                        const std::string& name,
                        int64_t num_pixels) {
  if (run.images.empty()) {
    return PipelineOutcome();
  }
  return ImagePipeline<RefineResult>(
             pass,
             run.images,
             run.options.pass == RefinePass::kAll
                 ? name
                 : "Shard " + ToString(run.options.shard) + ", " +
                       ToString(run.options.pass) + ":",
             run.devices.at_work,
             run.devices.at_work.MaxNumViews(num_pixels),
             run.progress)
      .Run();
}

PipelineOutcome Observe(const RefineRun& run,
                        std::vector<StageSeconds>& seconds) {
  if (run.HasScenePlanes()) {
    ObservePass observe(run, seconds);
    return RunPass(run, observe, "Pass 1 of 3:", NumJudgedPixels(run.overview));
  }
  // Images that are refined by themselves have nothing to observe.
  PipelineOutcome outcome(run.images.size());
  for (ImageReport& report : outcome.reports) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return outcome;
}

// Finds the planes of the scene, if they are needed and not known. Returns
// false where that was stopped or failed; then the outcome has the failure.
bool FindPlanes(const RefineRun& run, PipelineOutcome* outcome) {
  if (!run.HasScenePlanes() || !run.IsAnyNeeded() || run.HasCurrentPlanes()) {
    return true;
  }
  try {
    for (const size_t index : run.images) {
      run.evidence.RequireObserved(run.selection.Reference(index));
    }
    return ModelWorkspace(run);
  } catch (...) {
    outcome->first_failure = std::current_exception();
    return false;
  }
}

PipelineOutcome Compose(const RefineRun& run,
                        std::vector<StageSeconds> seconds) {
  for (const size_t index : run.images) {
    if (run.HasScenePlanes() && run.selection.IsToBeRefined(index)) {
      for (const int view : run.selection.SourcesAndReference(index)) {
        run.evidence.RequireObserved(view);
      }
    }
  }
  ComposePass compose(run, std::move(seconds));
  return RunPass(run,
                 compose,
                 run.HasScenePlanes() ? "Pass 3 of 3:" : "",
                 run.overview.max_num_pixels);
}

// Returns the outcome of the last pass of this run.
PipelineOutcome RunPasses(const RefineRun& run) {
  const RefinePass pass = run.options.pass;
  const bool runs_all = pass == RefinePass::kAll;
  std::vector<StageSeconds> seconds(run.selection.NumImages());
  PipelineOutcome outcome(run.images.size());
  outcome.num_observed = static_cast<int>(run.images.size());
  if (runs_all || pass == RefinePass::kObserve) {
    outcome = Observe(run, seconds);
    if (!runs_all) {
      return outcome;
    }
    const bool is_complete = outcome.IsComplete();
    // From here on, the outcome is that no image has been refined.
    outcome.num_observed = outcome.NumDone();
    outcome.reports.assign(run.images.size(), ImageReport());
    if (!is_complete) {
      return outcome;  // With unobserved views, the planes would be others.
    }
  }
  if (pass != RefinePass::kCompose && !FindPlanes(run, &outcome)) {
    return outcome;
  }
  return pass == RefinePass::kModel ? PipelineOutcome()
                                    : Compose(run, std::move(seconds));
}

RunSummary Summarize(const RefineRun& run, const PipelineOutcome& outcome) {
  RunSummary summary = SummarizeInputs(
      run.workspace, run.options.pass, run.workspace.ReferencesOf(run.images));
  summary.shard = run.options.shard;
  summary.device = run.devices.description;
  summary.num_workers = static_cast<int>(run.devices.workers.size());
  summary.peak_gpu_memory = PeakGpuMemory(run.devices);
  for (size_t i = 0; i < outcome.reports.size(); ++i) {
    summary.Add(run.selection.Name(run.images[i]), outcome.reports[i]);
  }
  if (run.options.pass == RefinePass::kObserve) {
    summary.num_observed = std::exchange(summary.num_refined, 0);
    summary.num_skipped = summary.num_images - summary.num_observed;
  }
  return summary;
}

// Every pass but kMerge.
RunSummary RunOnImages(const WorkspaceRefineOptions& options,
                       const RefineOptions& refine_options,
                       Progress& progress) {
  const Stopwatch stopwatch;
  const OpenCvWithoutThreads opencv_without_threads;
  const std::jthread preparing_gpus = BeginPreparingGpus(options.devices);
  const bool in_place = options.output_path.empty();
  const bool is_shard = options.pass == RefinePass::kObserve ||
                        options.pass == RefinePass::kCompose;
  Workspace workspace = OpenWorkspace(options);
  std::optional<WorkspaceLock> input_lock;
  std::optional<WorkspaceLock> lock;
  if (in_place) {
    lock.emplace(workspace.Root(),
                 is_shard ? WorkspaceLock::Mode::kShard
                          : WorkspaceLock::Mode::kExclusive,
                 options.shard.index);
  } else {
    // Keeps others from changing the originals while they are read.
    input_lock.emplace(workspace.Root(), WorkspaceLock::Mode::kShared);
  }
  // The inputs are checked before anything is written.
  const std::vector<size_t> images =
      SplitImages(workspace, options.shard.count)[options.shard.index];
  std::vector<bool> is_listed =
      FindListedImages(workspace, options.image_list_path);
  const WorkspaceOverview overview =
      CheckWorkspace(workspace, options.devices.num_threads);
  MemoryPlan memory = PlanRefinement(refine_options, overview);
  if (options.pass == RefinePass::kModel) {
    // A GPU too small for observing or composing may suffice here.
    memory.device = memory.main = memory.views = 0;
  }
  PipelineDevices devices;
  if (!images.empty()) {
    devices = OpenPipelineDevices(
        options.devices, memory, static_cast<int>(images.size()));
  }
  if (!in_place) {
    BeginOutputWorkspace(workspace, options.output_path);
    lock.emplace(options.output_path);
    workspace = CreateOutputWorkspace(workspace, options.output_path);
  }
  std::vector<std::string> obstacles =
      FindFusionObstacles(workspace.Model(), workspace.ModelFolder());
  std::ranges::for_each(obstacles, &Warn);
  const InputFingerprints inputs(workspace);
  const ImageRecord expected = CurrentRecord(workspace, refine_options, inputs);
  const ImageSelection selection(
      workspace, inputs, overview.has_maps, std::move(is_listed), expected);
  if (NeedsEvidence(refine_options)) {
    selection.RequireOthersFit(options.image_list_path);
  }
  if (options.pass == RefinePass::kAll ||
      options.pass == RefinePass::kObserve) {
    selection.WarnOfChanges();
  }
  EvidenceStore evidence(workspace,
                         expected.options_hash + " " + expected.inputs,
                         NumEvidenceViews(overview, devices.NumScenes()));
  const RefineRun run = {options,
                         refine_options,
                         progress,
                         workspace,
                         overview,
                         images,
                         devices,
                         inputs,
                         selection,
                         evidence};
  BeginManifest(run);
  const PipelineOutcome outcome = RunPasses(run);
  RunSummary summary = Summarize(run, outcome);
  FinishManifest(run, outcome);
  summary.fusion_obstacles = std::move(obstacles);
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
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
  RequirePathOfPriorType(prior_path, prior_type);
  devices.Check();
  shard.Check();
  require(pass != RefinePass::kAll || shard.count == 1,
          OptionName("shard") +
              ": a part of the images needs what is observed in the "
              "others; run " +
              OptionName("pass") +
              " observe for all shards, then model, then "
              "compose for all, then merge");
  require((pass != RefinePass::kModel && pass != RefinePass::kMerge) ||
              shard.count == 1,
          OptionName("shard") + ": " + OptionName("pass") + " " +
              ToString(pass) +
              " is for all shards together; "
              "leave it out");
  require(pass == RefinePass::kAll || image_list_path.empty(),
          OptionName("image_list_path") +
              ": shards work on all images; leave it out, or run " +
              OptionName("pass") + " all");
  require(
      pass == RefinePass::kAll || output_path.empty(),
      OptionName("output_path") +
          ": shards refine in place; leave it out, and make a copy "
          "of links first (cp -as) where the workspace is to stay as it is");
}

RunSummary RefineWorkspace(const WorkspaceRefineOptions& workspace_options,
                           const RefineOptions& refine_options,
                           Progress& progress) {
  workspace_options.Check();
  refine_options.Check();
  if (!workspace_options.prior_path.empty() && !NeedsEvidence(refine_options)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("prior_path") +
                    ": depth priors are used together with the planes of the "
                    "scene alone; leave it out, or turn " +
                    OptionName("scene_planes") + " on");
  }
  return workspace_options.pass == RefinePass::kMerge
             ? MergeShards(workspace_options, refine_options)
             : RunOnImages(workspace_options, refine_options, progress);
}

}  // namespace tsar
