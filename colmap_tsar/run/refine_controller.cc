// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_controller.h"

#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/raster_memory.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/fusion_obstacles.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/listed_images.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/run/open_workspace.h"
#include "colmap_tsar/run/refine_passes.h"
#include "colmap_tsar/run/run_account.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <exception>
#include <memory>
#include <optional>
#include <utility>

namespace tsar {
namespace {

// Approximate relative times of observing, the model and composing. Measured: 1
// : 0.26 : 0.87 and 1 : 0.51 : 0.93 on two cores, 1 : 0.87 : 1.17 on a GPU.
const std::vector<double> kPassCosts = {1.0, 0.5, 1.0};

}  // namespace

RefineController::RefineController(const WorkspaceRefineOptions& options,
                                   const RefineOptions& refine_options,
                                   Progress& progress,
                                   const std::function<bool()>& should_stop,
                                   RefineObserver* observer)
    : options_(options),
      refine_options_(refine_options),
      progress_(progress),
      should_stop_(should_stop),
      observer_(IsShard() ? nullptr : observer),
      workspace_(OpenWorkspace(options)),
      shards_(SplitImages(workspace_, options.shard.count)) {
  Lock();
}

void RefineController::Lock() {
  const bool in_place = options_.output_path.empty();
  if (IsShard()) {
    lock_.emplace(workspace_.Root(),
                  options_.pass == RefinePass::kObserve
                      ? WorkspaceLock::Mode::kObserve
                      : WorkspaceLock::Mode::kCompose,
                  options_.shard.index);
  } else if (in_place) {
    lock_.emplace(workspace_.Root());
  }
  if (!in_place || workspace_.IsOutput()) {
    // The lock keeps others from changing the originals while they are read.
    input_lock_.emplace(workspace_.SourceRoot(),
                        workspace_.IsOutput()
                            ? WorkspaceLock::Mode::kSharedIfThere
                            : WorkspaceLock::Mode::kShared);
  }
}

RunSummary RefineController::Run() {
  FindListedImages(workspace_, options_.image_list_path);
  overview_ = CheckWorkspace(workspace_);
  if (overview_.num_with_alpha > 0) {
    Warn(std::to_string(overview_.num_with_alpha) +
         " images have an alpha channel, which is ignored; give what is "
         "transparent as black in masks, " +
         OptionName("mask_path"));
  }
  for (const std::string& obstacle : FusionObstacles()) {
    Warn(obstacle);
  }
  if (options_.pass != RefinePass::kCompose) {
    CheckOriginals(workspace_);
  }
  if (!Images().empty()) {
    devices_ = CreateRefineDevices(
        options_.devices,
        overview_,
        [&](const WorkspaceOverview& maps) {
          return PlanRefinement(refine_options_, maps);
        },
        static_cast<int>(Images().size()));
  }
  if (!options_.output_path.empty()) {
    OpenOutput();
  }
  const std::string options_hash = HashRefineOptions(refine_options_);
  InputFingerprints inputs(workspace_);
  // The images with workers, and those whose scenes are found ahead.
  const size_t num_scenes =
      devices_.workers.size() +
      (devices_.finds_scenes_ahead
           ? static_cast<size_t>(devices_.sizes.num_loaders)
           : 0);
  EvidenceStore evidence(workspace_,
                         inputs,
                         options_hash,
                         NumEvidenceViews(overview_, num_scenes));
  const SceneModelStore model(workspace_, inputs, options_hash);
  // An observer is to see every image.
  RefinePlan plan(workspace_,
                  inputs,
                  overview_.has_maps,
                  FindListedImages(workspace_, options_.image_list_path),
                  options_hash,
                  NeedsEvidence(refine_options_) ? model.PlanesFingerprint()
                                                 : std::string(),
                  /*reuses_results=*/observer_ == nullptr);
  if (NeedsEvidence(refine_options_)) {
    plan.RequireOthersFit(options_.image_list_path);
  }
  ViewLoader loader(workspace_, plan, refine_options_.distrust_unmatched);
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
                         loader,
                         observer_};
  std::unique_ptr<RunAccount> account;
  if (IsShard()) {
    account = std::make_unique<ShardAccount>(run);
  } else {
    account = std::make_unique<ManifestAccount>(run);
  }
  account->Begin();
  const PipelineOutcome outcome = RunPasses(run, *account);
  RunSummary summary = Summarize(run, outcome);
  account->End(outcome);
  return summary;
}

std::vector<std::string> RefineController::FusionObstacles() const {
  return FindFusionObstacles(workspace_.Model(), workspace_.ModelFolder());
}

void RefineController::OpenOutput() {
  if (ReadOutputMarker(options_.output_path)) {
    // Another program may be at work on it.
    lock_.emplace(options_.output_path);
  }
  const bool has_own_list = workspace_.IsOutput();
  workspace_ = CreateOutputWorkspace(
      workspace_, options_.output_path, workspace_.Type());
  workspace_.UseMasks(options_.mask_path);
  workspace_.UsePriors(options_.prior_path, options_.prior_type);
  workspace_.UseLabelImages(options_.region_path);
  if (!lock_) {
    lock_.emplace(workspace_.Root());
  }
  if (has_own_list) {
    // The image list of an output's output is that of the first workspace.
    overview_ = CheckWorkspace(workspace_);
  }
  shards_ = SplitImages(workspace_, options_.shard.count);
}

PipelineOutcome RefineController::RunPasses(const RefineRun& run,
                                            RunAccount& account) {
  const std::vector<size_t>& images = Images();
  const auto run_pass = [&](ImageTasks<RefineResult>& pass,
                            const std::string& name,
                            bool has_reduced_views) {
    if (images.empty()) {
      return PipelineOutcome();
    }
    progress_.BeginPass();
    ViewCache cache(
        devices_.cache_num_bytes,
        static_cast<size_t>(has_reduced_views ? ReducedViewBytes(overview_)
                                              : ViewBytes(overview_)),
        [&](int image) {
          return has_reduced_views ? run.loader.LoadReduced(image)
                                   : run.loader.Load(image);
        });
    const RasterMemoryReuse reuse(devices_.raster_num_bytes);
    return ImagePipeline<RefineResult>(
               pass,
               images,
               IsShard() ? "Shard " + ToString(options_.shard) + ", " +
                               ToString(options_.pass) + ":"
                         : name,
               cache,
               devices_.sizes,
               progress_,
               should_stop_)
        .Run(devices_.workers.size());
  };
  if (run.HasScenePlanes() && !IsShard()) {
    std::vector<double> costs = kPassCosts;
    // Images that are not listed are only observed.
    costs.back() *= static_cast<double>(run.plan.NumListed()) /
                    static_cast<double>(run.plan.NumImages());
    progress_.PlanPasses(std::move(costs));
  }
  std::vector<StageSeconds> seconds(run.plan.NumImages());

  if (options_.pass != RefinePass::kCompose) {
    // Pass 1: the evidence of all images.
    account.BeforeObserving();
    PipelineOutcome outcome(images.size());
    if (run.HasScenePlanes()) {
      ObservePass observe(run, seconds);
      // Images are observed at the size at which they are judged, and composed
      // at that of their maps.
      outcome = run_pass(observe, "Pass 1 of 3:", HasReducedViews(overview_));
    } else {
      // Images that are refined by themselves have nothing to observe.
      for (ImageReport& report : outcome.reports) {
        report.outcome = ImageReport::Outcome::kSkipped;
      }
    }
    if (options_.pass == RefinePass::kObserve) {
      return outcome;
    }
    // Pass 2: the planes of the scene, which would be others with unobserved
    // views. From here on, the outcome is that no image has been refined.
    bool is_complete = outcome.IsComplete();
    outcome.num_observed = outcome.NumDone();
    outcome.reports.assign(images.size(), ImageReport());
    if (is_complete && run.HasScenePlanes()) {
      progress_.BeginPass(/*has_parts=*/true);
      if (run.IsAnyNeeded() && !run.model.IsCurrent()) {
        try {
          is_complete = ModelWorkspace(
              {workspace_, run.plan, run.evidence, run.model, refine_options_},
              devices_.model,
              "Pass 2 of 3, scene model,",
              progress_,
              should_stop_);
        } catch (...) {
          outcome.first_failure = std::current_exception();
          is_complete = false;
        }
      }
    }
    if (!is_complete) {
      return outcome;
    }
  }

  // Pass 3, or the only one: the maps.
  account.BeforeComposing();
  ComposePass compose(run, std::move(seconds));
  return run_pass(compose,
                  run.HasScenePlanes() ? "Pass 3 of 3:" : "",
                  /*has_reduced_views=*/false);
}

RunSummary RefineController::Summarize(const RefineRun& run,
                                       const PipelineOutcome& outcome) const {
  RunSummary summary;
  summary.workspace_path = workspace_.Root();
  summary.model_folder = workspace_.ModelFolder();
  summary.fusion_obstacles = FusionObstacles();
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

}  // namespace tsar
