// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_shard.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/image_pipeline.h"
#include "colmap_tsar/controllers/image_runner.h"
#include "colmap_tsar/controllers/input_fingerprints.h"
#include "colmap_tsar/controllers/memory_plan.h"
#include "colmap_tsar/controllers/observe_runner.h"
#include "colmap_tsar/controllers/refine_devices.h"
#include "colmap_tsar/controllers/refine_setup.h"
#include "colmap_tsar/controllers/selected_images.h"
#include "colmap_tsar/controllers/shard_entries.h"
#include "colmap_tsar/controllers/workspace_check.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/store/workspace_lock.h"
#include "colmap_tsar/store/write_back.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tsar {
namespace {

using Clock = std::chrono::steady_clock;
using State = ShardRecord::State;

class ShardRun {
 public:
  ShardRun(const WorkspaceRefineOptions& workspace_options,
           const RefineOptions& refine_options,
           Progress& progress,
           const std::function<bool()>& should_stop)
      : workspace_options_(workspace_options),
        refine_options_(refine_options),
        progress_(progress),
        should_stop_(should_stop),
        pass_(ParsePass(workspace_options.pass)),
        shard_(ParseShard(workspace_options.shard)),
        workspace_(OpenWorkspace(workspace_options)),
        lock_(workspace_.Root(),
              pass_ == RefinePass::kObserve ? WorkspaceLock::Mode::kObserve
                                            : WorkspaceLock::Mode::kCompose,
              shard_.index),
        shards_(SplitImages(workspace_, shard_.count)) {
    if (workspace_.IsOutput()) {
      // So that nobody changes the originals while they are read.
      input_lock_.emplace(workspace_.SourceRoot(),
                          WorkspaceLock::Mode::kSharedIfThere);
    }
  }

  RunSummary Run() {
    const WorkspaceOverview overview = CheckWorkspace(workspace_);
    if (pass_ == RefinePass::kObserve) {
      CheckOriginals(workspace_);
    }
    if (!Images().empty()) {
      devices_ = CreateRefineDevices(
          workspace_options_,
          overview,
          [&](const WorkspaceOverview& maps) {
            return PlanRefinement(refine_options_, maps);
          },
          static_cast<int>(Images().size()));
    }
    const bool has_scene =
        refine_options_.scene_planes && refine_options_.refine;
    InputFingerprints inputs(workspace_, has_scene);
    EvidenceStore evidence(workspace_,
                           inputs,
                           HashRefineOptions(refine_options_),
                           NumEvidenceViews(overview, devices_.workers.size()));
    ImageRunner runner(workspace_,
                       overview.has_maps,
                       refine_options_,
                       devices_.workers,
                       inputs,
                       has_scene ? &evidence : nullptr,
                       devices_.finds_scenes_ahead);
    ViewCache cache(devices_.cache_num_bytes,
                    static_cast<size_t>(ViewBytes(overview)),
                    [&](int image) { return runner.Load(image); });
    record_ = DescribeShard(workspace_, refine_options_, pass_, shard_);
    record_.runtime = ShardRuntime(workspace_options_, devices_);
    for (const size_t index : Images()) {
      record_.images.push_back({Name(index), State::kNeeded, {}, ""});
    }
    if (pass_ == RefinePass::kObserve) {
      BeginShard(workspace_.Root(), record_);
      Observe(has_scene, inputs, evidence, runner, cache);
    } else {
      const ObservedShards observed =
          ReadObservedShards(workspace_, record_, shards_);
      BeginShard(workspace_.Root(), record_);
      Compose(has_scene, observed, inputs, evidence, runner, cache);
    }
    return Summarize();
  }

 private:
  const std::vector<size_t>& Images() const {
    return shards_[static_cast<size_t>(shard_.index)];
  }
  int Reference(size_t index) const {
    return workspace_.Problems()[index].reference;
  }
  const std::string& Name(size_t index) const {
    return workspace_.Model()
        .images[static_cast<size_t>(Reference(index))]
        .name;
  }

  void Observe(bool has_scene,
               InputFingerprints& inputs,
               EvidenceStore& evidence,
               ImageRunner& runner,
               ViewCache& cache) {
    for (size_t i = 0; i < Images().size(); ++i) {
      const size_t index = Images()[i];
      if (!has_scene && !workspace_.IsOutput() &&
          runner.HasMaps(Reference(index))) {
        // The other shards will read it, whatever becomes of the maps.
        StoreOriginals(workspace_, Reference(index));
      }
      record_.images[i].inputs = inputs.OfView(Reference(index));
    }
    ObserveRunner observer(runner, evidence);
    if (has_scene) {
      Work(observer, cache);
    }
    for (size_t i = 0; i < Images().size(); ++i) {
      const size_t index = Images()[i];
      ShardRecord::Entry& entry = record_.images[i];
      if (!has_scene || !runner.CanCompute(index)) {
        entry.state = State::kNothing;
      } else if (!runner.IsNeeded(index)) {
        entry.state = State::kNotNeeded;
      } else if (evidence.IsCurrent(Reference(index))) {
        entry.state = State::kObserved;
      } else {
        entry.state = State::kNothing;
      }
    }
    record_.is_complete = true;
    WriteShardRecord(workspace_.Root(), record_);
  }

  void Compose(bool has_scene,
               const ObservedShards& observed,
               InputFingerprints& inputs,
               EvidenceStore& evidence,
               ImageRunner& runner,
               ViewCache& cache) {
    std::vector<int> own;
    for (const size_t index : Images()) {
      own.push_back(Reference(index));
    }
    inputs.Expect(observed.inputs, own);
    for (const int image : own) {
      inputs.OfView(image);
    }
    if (has_scene) {
      evidence.Expect(observed.with_evidence);
      for (const size_t index : Images()) {
        if (runner.CanCompute(index) && !runner.HasBeenRefined(index)) {
          for (const int view : runner.SourcesAndReference(index)) {
            RequireObserved(workspace_, view, observed);
            evidence.IsCurrent(view);
          }
        }
      }
    } else if (!workspace_.IsOutput()) {
      workspace_.TrustStoredOriginals();
    }
    Work(runner, cache);
    for (ShardRecord::Entry& entry : record_.images) {
      entry.state = State::kComposed;
    }
    record_.is_complete = true;
    WriteShardRecord(workspace_.Root(), record_);
  }

  // Throws what went wrong with an image, or that the user asked to stop.
  void Work(ImageTasks& tasks, ViewCache& cache) {
    SelectedImages selected(
        tasks,
        Images(),
        "Shard " + ToString(shard_) + ", " + ToString(pass_) + ":");
    ImagePipeline pipeline(
        selected, cache, devices_.sizes, progress_, should_stop_);
    if (Images().empty()) {
      return;
    }
    pipeline.Run(devices_.workers.size());
    reports_ = pipeline.Reports();
    if (NoteFailures(pipeline.Failures(), &record_)) {
      try {
        WriteShardRecord(workspace_.Root(), record_);
      } catch (const Error&) {
        // On a full disk the failure of the image says more.
      }
    }
    RethrowFailure(pipeline);
    if (!IsComplete(pipeline)) {
      const auto num_left = std::count_if(
          reports_.begin(), reports_.end(), [](const ImageReport& report) {
            return report.outcome == ImageReport::Outcome::kNotDone;
          });
      const int num_images = static_cast<int>(reports_.size());
      throw Interrupted(num_images - static_cast<int>(num_left), num_images);
    }
  }

  RunSummary Summarize() const {
    RunSummary summary;
    summary.workspace_path = workspace_.Root();
    summary.type = workspace_.Type();
    summary.pass = pass_;
    summary.shard = shard_;
    summary.device = devices_.description;
    summary.num_workers = static_cast<int>(devices_.workers.size());
    summary.peak_gpu_memory = PeakGpuMemory(devices_);
    summary.num_images = static_cast<int>(Images().size());
    for (size_t i = 0; i < reports_.size(); ++i) {
      summary.Add(Name(Images()[i]), reports_[i]);
    }
    if (pass_ == RefinePass::kObserve) {
      summary.num_observed = std::exchange(summary.num_refined, 0);
      summary.num_skipped = summary.num_images - summary.num_observed;
    }
    summary.wall_seconds =
        std::chrono::duration<double>(Clock::now() - start_).count();
    return summary;
  }

  const Clock::time_point start_ = Clock::now();
  const OpenCvWithoutThreads opencv_without_threads_;
  const WorkspaceRefineOptions& workspace_options_;
  const RefineOptions& refine_options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const RefinePass pass_;
  const Shard shard_;
  Workspace workspace_;
  const WorkspaceLock lock_;
  std::optional<WorkspaceLock> input_lock_;
  // Places in Problems().
  const std::vector<std::vector<size_t>> shards_;
  RefineDevices devices_;
  ShardRecord record_;
  std::vector<ImageReport> reports_;
};

}  // namespace

RunSummary RefineShard(const WorkspaceRefineOptions& workspace_options,
                       const RefineOptions& refine_options,
                       Progress& progress,
                       const std::function<bool()>& should_stop) {
  return ShardRun(workspace_options, refine_options, progress, should_stop)
      .Run();
}

}  // namespace tsar
