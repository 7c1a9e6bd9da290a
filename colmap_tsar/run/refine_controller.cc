// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_controller.h"

#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/raster_memory.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/fusion_obstacles.h"
#include "colmap_tsar/run/compose_task.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/listed_images.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/model_pass.h"
#include "colmap_tsar/run/open_workspace.h"
#include "colmap_tsar/run/refine_task.h"
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
  ImageCatalog catalog(workspace_,
                       overview_.has_maps,
                       options_hash,
                       inputs,
                       NeedsEvidence(refine_options_)
                           ? model.PlanesFingerprint()
                           : std::string(),
                       /*reuses_results=*/observer_ == nullptr,
                       refine_options_.distrust_unmatched);
  RefineListedImages(workspace_,
                     options_.image_list_path,
                     NeedsEvidence(refine_options_),
                     &catalog);
  const RefineRun run = {options_,
                         refine_options_,
                         workspace_,
                         shards_,
                         devices_,
                         inputs,
                         evidence,
                         model,
                         catalog};
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
  const auto pass_name = [&](const std::string& of_all_images) {
    return IsShard() ? "Shard " + ToString(options_.shard) + ", " +
                           ToString(options_.pass) + ":"
                     : of_all_images;
  };
  const RefineTaskInputs inputs = {
      run.catalog, refine_options_, devices_.workers, observer_};
  // Images are observed at the size at which they are judged, and composed at
  // that of their maps.
  const bool has_reduced_views = run.HasScenePlanes() &&
                                 options_.pass != RefinePass::kCompose &&
                                 HasReducedViews(overview_);
  std::optional<ViewCache> cache;
  const auto make_cache = [&](bool is_reduced) {
    cache.emplace(devices_.cache_num_bytes,
                  static_cast<size_t>(is_reduced ? ReducedViewBytes(overview_)
                                                 : ViewBytes(overview_)),
                  [&run, is_reduced](int image) {
                    return is_reduced ? run.catalog.LoadReduced(image)
                                      : run.catalog.Load(image);
                  });
  };
  make_cache(has_reduced_views);
  if (run.HasScenePlanes() && !IsShard()) {
    std::vector<double> costs = kPassCosts;
    // Images that are not listed are only observed.
    costs.back() *= static_cast<double>(run.catalog.NumListed()) /
                    static_cast<double>(run.catalog.NumImages());
    progress_.PlanPasses(std::move(costs));
  }
  if (options_.pass != RefinePass::kCompose) {
    account.BeforeObserving();
    const PipelineOutcome outcome =
        Observe(run, inputs, pass_name("Pass 1 of 3:"), *cache);
    if (options_.pass == RefinePass::kObserve) {
      return outcome;
    }
    // The planes are found in the evidence alone, which needs the memory.
    cache.reset();
    PipelineOutcome none_refined(Images().size());
    none_refined.failures = outcome.failures;
    none_refined.first_failure = outcome.first_failure;
    none_refined.num_observed = outcome.NumDone();
    // The planes of a scene with unobserved views would be others.
    if (!outcome.IsComplete() || !Model(run, &none_refined)) {
      return none_refined;
    }
  }
  if (!cache) {
    make_cache(false);
  }
  account.BeforeComposing();
  if (run.HasScenePlanes()) {
    progress_.BeginPass();
    run.catalog.UsePlanes(run.model.PlanesFingerprint());
    ComposeTask compose(inputs,
                        workspace_,
                        run.evidence,
                        run.IsAnyNeeded() ? run.model.Read() : SceneModel(),
                        overview_.map_sides,
                        devices_.finds_scenes_ahead);
    return RunPass(compose, pass_name("Pass 3 of 3:"), *cache);
  }
  SingleViewTask refine(inputs);
  return RunPass(refine, pass_name(""), *cache);
}

PipelineOutcome RefineController::Observe(const RefineRun& run,
                                          const RefineTaskInputs& inputs,
                                          std::string name,
                                          ViewCache& cache) {
  if (!run.HasScenePlanes()) {
    // Images that are refined by themselves have nothing to observe.
    ImageReport nothing_to_do;
    nothing_to_do.outcome = ImageReport::Outcome::kSkipped;
    PipelineOutcome outcome(Images().size());
    outcome.reports.assign(Images().size(), nothing_to_do);
    return outcome;
  }
  ObserveTask observe(inputs,
                      run.evidence,
                      run.catalog.ReusesResults() && run.model.IsCurrent());
  progress_.BeginPass();
  return RunPass(observe, std::move(name), cache);
}

bool RefineController::Model(const RefineRun& run, PipelineOutcome* outcome) {
  progress_.BeginPass(/*has_parts=*/true);
  if (!run.HasScenePlanes() || !run.IsAnyNeeded() || run.model.IsCurrent()) {
    return true;
  }
  try {
    return ModelWorkspace(
        {workspace_, run.catalog, run.evidence, run.model, refine_options_},
        devices_.model,
        "Pass 2 of 3, scene model,",
        progress_,
        should_stop_);
  } catch (...) {
    outcome->first_failure = std::current_exception();
    return false;
  }
}

PipelineOutcome RefineController::RunPass(RefineTask& task,
                                          std::string name,
                                          ViewCache& cache) {
  if (Images().empty()) {
    return PipelineOutcome();
  }
  const RasterMemoryReuse reuse(devices_.raster_num_bytes);
  return ImagePipeline<RefineResult>(task,
                                     Images(),
                                     std::move(name),
                                     cache,
                                     devices_.sizes,
                                     progress_,
                                     should_stop_)
      .Run(devices_.workers.size());
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
    const int image = run.catalog.Reference(Images()[i]);
    summary.Add(run.catalog.Name(image), outcome.reports[i]);
  }
  if (options_.pass == RefinePass::kObserve) {
    summary.num_observed = std::exchange(summary.num_refined, 0);
    summary.num_skipped = summary.num_images - summary.num_observed;
  }
  summary.wall_seconds = stopwatch_.Seconds();
  return summary;
}

}  // namespace tsar
