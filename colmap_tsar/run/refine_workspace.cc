// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/run/refine_passes.h"
#include "colmap_tsar/run/run_account.h"
#include "colmap_tsar/run/shard_passes.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cstddef>
#include <exception>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// One run of tsar_refine over the images of a shard, in every pass but kModel
// and kMerge. A run over all images is that of shard 0 of 1.
class RefineController {
 public:
  // Opens and locks the workspace. The arguments must outlive this object.
  RefineController(const WorkspaceRefineOptions& options,
                   const RefineOptions& refine_options,
                   Progress& progress,
                   const std::function<bool()>& should_stop)
      : options_(options),
        refine_options_(refine_options),
        progress_(progress),
        should_stop_(should_stop),
        workspace_(OpenWorkspace(options)),
        shards_(SplitImages(workspace_, options.shard.count)) {
    Lock();
  }

  // See RefineWorkspace.
  RunSummary Run();

 private:
  bool IsShard() const { return options_.pass != RefinePass::kAll; }
  const std::vector<size_t>& Images() const {
    return shards_[options_.shard.index];
  }
  void Lock();
  // Checks the inputs before anything is written.
  void Check();
  // Makes the workspace at output_path and continues with it.
  void OpenOutput();
  // Returns the outcome of the last pass of this run.
  PipelineOutcome RunPasses(const RefineRun& run);
  // Throws where a view that a shard needs to compose was not observed.
  void RequireObserved(const RefineRun& run);
  PipelineOutcome Observe(const RefineRun& run,
                          std::vector<StageSeconds>& seconds);
  // Finds the planes of the scene, if they are needed and not known. Returns
  // false where that was stopped or failed; then the outcome has the failure.
  bool FindPlanes(const RefineRun& run, PipelineOutcome* outcome);
  // name: for the user. num_pixels: of the largest view.
  PipelineOutcome RunPass(ImageTasks<RefineResult>& pass,
                          const std::string& name,
                          int64_t num_pixels);
  RunSummary Summarize(const RefineRun& run,
                       const PipelineOutcome& outcome) const;

  const Stopwatch stopwatch_;
  const OpenCvWithoutThreads opencv_without_threads_;
  const WorkspaceRefineOptions& options_;
  const RefineOptions& refine_options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  Workspace workspace_;
  std::optional<WorkspaceLock> lock_;
  std::optional<WorkspaceLock> input_lock_;
  // Indices in Problems(), by shard.
  std::vector<std::vector<size_t>> shards_;
  std::vector<bool> is_listed_;  // As shards_.
  WorkspaceOverview overview_;
  RefineDevices devices_;
};

void RefineController::Lock() {
  const bool in_place = options_.output_path.empty();
  if (IsShard()) {
    lock_.emplace(
        workspace_.Root(), WorkspaceLock::Mode::kShard, options_.shard.index);
  } else if (in_place) {
    lock_.emplace(workspace_.Root());
  }
  if (!in_place) {
    // The lock keeps others from changing the originals while they are read.
    input_lock_.emplace(workspace_.Root(), WorkspaceLock::Mode::kShared);
  }
}

void RefineController::Check() {
  is_listed_ = FindListedImages(workspace_, options_.image_list_path);
  overview_ = CheckWorkspace(workspace_);
  if (overview_.num_with_alpha > 0) {
    Warn(std::to_string(overview_.num_with_alpha) +
         " images have an alpha channel, which is ignored; give what is "
         "transparent as black in masks, " +
         OptionName("mask_path"));
  }
  for (const std::string& obstacle :
       FindFusionObstacles(workspace_.Model(), workspace_.ModelFolder())) {
    Warn(obstacle);
  }
}

RunSummary RefineController::Run() {
  Check();
  if (!Images().empty()) {
    devices_ = CreateRefineDevices(options_.devices,
                                   PlanRefinement(refine_options_, overview_),
                                   static_cast<int>(Images().size()));
  }
  if (!options_.output_path.empty()) {
    OpenOutput();
  }
  const std::string options_hash = HashRefineOptions(refine_options_);
  const InputFingerprints inputs(workspace_);
  EvidenceStore evidence(workspace_,
                         inputs,
                         options_hash,
                         NumEvidenceViews(overview_, devices_.NumScenes()));
  const SceneModelStore model(workspace_, inputs, options_hash);
  const RefinePlan plan(
      workspace_,
      inputs,
      overview_.has_maps,
      is_listed_,
      options_hash,
      NeedsEvidence(refine_options_) ? model.PlanesFingerprint() : "");
  if (NeedsEvidence(refine_options_)) {
    plan.RequireOthersFit(options_.image_list_path);
  }
  if (options_.pass != RefinePass::kCompose) {
    plan.WarnOfChanges();
  }
  ViewLoader loader(workspace_);
  const RefineRun run = {options_,
                         refine_options_,
                         workspace_,
                         overview_,
                         shards_,
                         devices_,
                         inputs,
                         evidence,
                         model,
                         plan,
                         loader};
  BeginAccount(run);
  const PipelineOutcome outcome = RunPasses(run);
  RunSummary summary = Summarize(run, outcome);
  EndAccount(run, outcome);
  return summary;
}

void RefineController::OpenOutput() {
  BeginOutputWorkspace(workspace_, options_.output_path);
  lock_.emplace(options_.output_path);
  workspace_ = CreateOutputWorkspace(
      workspace_, options_.output_path, workspace_.Type());
  workspace_.UseMasks(options_.mask_path);
  workspace_.UsePriors(options_.prior_path, options_.prior_type);
}

void RefineController::RequireObserved(const RefineRun& run) {
  for (const size_t index : Images()) {
    if (run.plan.IsToBeRefined(index)) {
      for (const int view : run.plan.SourcesAndReference(index)) {
        run.evidence.RequireObserved(view);
      }
    }
  }
}

PipelineOutcome RefineController::RunPasses(const RefineRun& run) {
  if (run.HasScenePlanes() && options_.pass == RefinePass::kCompose) {
    RequireObserved(run);
  }
  std::vector<StageSeconds> seconds(run.plan.NumImages());
  if (options_.pass != RefinePass::kCompose) {
    PipelineOutcome outcome = Observe(run, seconds);
    if (options_.pass == RefinePass::kObserve) {
      return outcome;
    }
    const bool is_complete = outcome.IsComplete();
    // From here on, the outcome is that no image has been refined.
    outcome.num_observed = outcome.NumDone();
    outcome.reports.assign(Images().size(), ImageReport());
    // With unobserved views, the planes would be others.
    if (!is_complete || !FindPlanes(run, &outcome)) {
      return outcome;
    }
  }
  ComposePass compose(run, std::move(seconds));
  return RunPass(compose,
                 run.HasScenePlanes() ? "Pass 3 of 3:" : "",
                 overview_.max_num_pixels);
}

PipelineOutcome RefineController::Observe(const RefineRun& run,
                                          std::vector<StageSeconds>& seconds) {
  if (run.HasScenePlanes()) {
    ObservePass observe(run, seconds);
    return RunPass(observe, "Pass 1 of 3:", NumJudgedPixels(overview_));
  }
  // Images that are refined by themselves have nothing to observe.
  PipelineOutcome outcome(Images().size());
  for (ImageReport& report : outcome.reports) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return outcome;
}

bool RefineController::FindPlanes(const RefineRun& run,
                                  PipelineOutcome* outcome) {
  if (!run.HasScenePlanes() || !run.IsAnyNeeded() || run.model.IsCurrent()) {
    return true;
  }
  try {
    return ModelWorkspace(
        {workspace_, run.plan, run.evidence, run.model, refine_options_},
        devices_.model,
        "Pass 2 of 3, scene model,",
        progress_,
        should_stop_);
  } catch (...) {
    outcome->first_failure = std::current_exception();
    return false;
  }
}

PipelineOutcome RefineController::RunPass(ImageTasks<RefineResult>& pass,
                                          const std::string& name,
                                          int64_t num_pixels) {
  if (Images().empty()) {
    return PipelineOutcome();
  }
  return ImagePipeline<RefineResult>(
             pass,
             Images(),
             IsShard() ? "Shard " + ToString(options_.shard) + ", " +
                             ToString(options_.pass) + ":"
                       : name,
             devices_.at_work,
             devices_.at_work.MaxNumViews(num_pixels),
             progress_,
             should_stop_)
      .Run();
}

RunSummary RefineController::Summarize(const RefineRun& run,
                                       const PipelineOutcome& outcome) const {
  RunSummary summary;
  summary.workspace_path = workspace_.Root();
  summary.model_folder = workspace_.ModelFolder();
  // Unlike the warnings, they name the folder of the workspace to be fused.
  summary.fusion_obstacles =
      FindFusionObstacles(workspace_.Model(), workspace_.ModelFolder());
  summary.type = workspace_.Type();
  summary.pass = options_.pass;
  summary.shard = options_.shard;
  summary.device = devices_.description;
  summary.num_workers = static_cast<int>(devices_.workers.size());
  summary.peak_gpu_memory = PeakGpuMemory(devices_);
  summary.num_images = static_cast<int>(Images().size());
  summary.num_masks = run.NumMasks();
  summary.num_priors = run.NumPriors();
  for (size_t i = 0; i < outcome.reports.size(); ++i) {
    summary.Add(run.plan.Name(Images()[i]), outcome.reports[i]);
  }
  if (options_.pass == RefinePass::kObserve) {
    summary.num_observed = std::exchange(summary.num_refined, 0);
    summary.num_skipped = summary.num_images - summary.num_observed;
  }
  summary.wall_seconds = stopwatch_.Seconds();
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
                           Progress& progress,
                           const std::function<bool()>& should_stop) {
  workspace_options.Check();
  refine_options.Check();
  if (!workspace_options.prior_path.empty() && !NeedsEvidence(refine_options)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("prior_path") +
                    ": depth priors are used together with the planes of the "
                    "scene alone; leave it out, or turn " +
                    OptionName("scene_planes") + " on");
  }
  if (workspace_options.pass == RefinePass::kModel) {
    return ModelShards(
        workspace_options, refine_options, progress, should_stop);
  }
  if (workspace_options.pass == RefinePass::kMerge) {
    return MergeShards(workspace_options, refine_options);
  }
  return RefineController(
             workspace_options, refine_options, progress, should_stop)
      .Run();
}

}  // namespace tsar
