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
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cstddef>
#include <cstdint>
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
  if (!NeedsEvidence(refine_options)) {
    return;
  }
  const WorkspaceOverview overview = CheckWorkspace(workspace);
  const MemoryPlan memory = PlanRefinement(refine_options, overview);
  const std::string options_hash = HashRefineOptions(refine_options);
  const InputFingerprints inputs(workspace);
  const SceneModelStore store(workspace, inputs, options_hash);
  const RefinePlan plan(workspace,
                        inputs,
                        overview.has_maps,
                        FindListedImages(workspace, {}),
                        options_hash,
                        store.PlanesFingerprint());
  if (store.IsCurrent() || !plan.IsAnyNeeded()) {
    return;
  }
  // A GPU too small for observing or composing may suffice here.
  const std::vector<GpuWorkers> gpus =
      OpenGpus(options.devices,
               /*image_bytes=*/0,
               static_cast<int>(plan.NumImages()),
               GpuSystem::Cuda());
  const ModelResources resources = PlanModelPass(options.devices, memory, gpus);
  EvidenceStore evidence(workspace,
                         inputs,
                         options_hash,
                         NumEvidenceViews(overview, resources.num_views));
  for (size_t index = 0; index < plan.NumImages(); ++index) {
    evidence.RequireObserved(plan.Reference(index));
  }
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

// Throws where an image that can be refined has not been, as it is now.
void RequireAllDone(const Workspace& workspace,
                    const RefineOptions& options,
                    const InputFingerprints& inputs,
                    const Manifest& manifest) {
  ImageRecord expected;
  expected.options_hash = HashRefineOptions(options);
  expected.inputs = inputs.OfRun();
  if (NeedsEvidence(options)) {
    expected.planes = SceneModelStore(workspace, inputs, expected.options_hash)
                          .PlanesFingerprint();
  }
  std::string first;
  size_t num_missing = 0;
  for (size_t i = 0; i < manifest.images.size(); ++i) {
    const int image = workspace.Problems()[i].reference;
    if (manifest.images[i].status != ImageStatus::kKept &&
        !IsDone(workspace, image, expected)) {
      first = num_missing++ == 0 ? manifest.images[i].image : first;
    }
  }
  if (num_missing > 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        std::to_string(num_missing) + " of " +
            std::to_string(manifest.images.size()) +
            " images have not been refined with these options from what is "
            "there now, the first of them " +
            first,
        "run " + OptionName("pass") +
            " observe of all shards, model, and compose of all shards; what "
            "is done is skipped");
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
  Manifest manifest = BuildManifest(workspace,
                                    RefineOptionsText(refine_options),
                                    HashRefineOptions(refine_options));
  const InputFingerprints inputs(workspace);
  manifest.inputs = inputs.States();
  RequireAllDone(workspace, refine_options, inputs, manifest);
  std::vector<int> references;
  for (const StereoProblem& problem : workspace.Problems()) {
    references.push_back(problem.reference);
  }
  const std::optional<int64_t> num_masks = workspace.CountMasks(references);
  const std::optional<int64_t> num_priors =
      workspace.Priors().Count(references);
  NoteMasksAndPriors(num_masks, num_priors, &manifest);
  WriteManifest(workspace, manifest);
  EvidenceStore::Clear(workspace);
  SceneModelStore::DropLabels(workspace);

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
