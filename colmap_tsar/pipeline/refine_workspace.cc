// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/pipeline/image_runner.h"
#include "colmap_tsar/pipeline/refine_devices.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/pipeline/workspace_check.h"
#include "colmap_tsar/workspace/manifest.h"
#include "colmap_tsar/workspace/output_workspace.h"
#include "colmap_tsar/workspace/workspace_lock.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include <glog/logging.h>

namespace tsar {
namespace {

Workspace OpenWorkspace(const WorkspaceRefineOptions& options) {
  Workspace workspace(options.workspace_path,
                      options.input_type.value_or(MapType::kGeometric));
  if (!options.input_type && !HasAnyMap(workspace, MapType::kGeometric) &&
      HasAnyMap(workspace, MapType::kPhotometric)) {
    LOG(WARNING) << options.workspace_path.string()
                 << ": there are no geometric maps; refining the photometric "
                    "ones";
    return Workspace(options.workspace_path, MapType::kPhotometric);
  }
  return workspace;
}

// What the workers of a run share: the next image, and what came of the others.
class Run {
 public:
  Run(const Workspace& workspace,
      ImageRunner& runner,
      Progress& progress,
      const std::function<bool()>& should_stop)
      : problems_(workspace.Problems()),
        runner_(runner),
        progress_(progress),
        should_stop_(should_stop),
        reports_(problems_.size()),
        failures_(problems_.size()) {}

  // Returns when all images are done, one has failed or the user asked to stop.
  void Work(const std::vector<std::unique_ptr<Device>>& devices) {
    progress_.Start(static_cast<int>(problems_.size()));
    {
      std::vector<std::jthread> threads;
      for (size_t i = 1; i < devices.size(); ++i) {
        threads.emplace_back([&, i] { WorkOnImages(*devices[i]); });
      }
      WorkOnImages(*devices[0]);
    }
    progress_.Finish();
  }

  void AddTo(const Workspace& workspace, RunSummary* summary) const {
    for (size_t i = 0; i < problems_.size(); ++i) {
      const auto image = static_cast<size_t>(problems_[i].reference);
      summary->Add(workspace.Model().images[image].name, reports_[i]);
    }
  }

  // The first failure in the order of the images.
  void RethrowFailure() const {
    for (const std::exception_ptr& failure : failures_) {
      if (failure) {
        std::rethrow_exception(failure);
      }
    }
  }

  void MarkFailures(Manifest* manifest) const {
    for (size_t i = 0; i < problems_.size(); ++i) {
      if (!failures_[i]) {
        continue;
      }
      manifest->images[i].status = ImageStatus::kFailed;
      try {
        std::rethrow_exception(failures_[i]);
      } catch (const std::exception& error) {
        manifest->images[i].note = error.what();
      }
    }
  }

 private:
  void WorkOnImages(Device& device) {
    while (!has_failed_ && !should_stop_()) {
      const size_t index = next_++;
      if (index >= problems_.size()) {
        return;
      }
      try {
        reports_[index] = runner_.Run(problems_[index], device);
      } catch (...) {
        failures_[index] = std::current_exception();
        has_failed_ = true;
        return;
      }
      if (reports_[index].outcome != ImageReport::Outcome::kNotDone) {
        progress_.Advance(reports_[index].outcome ==
                          ImageReport::Outcome::kRefined);
      }
    }
  }

  const std::vector<StereoProblem>& problems_;
  ImageRunner& runner_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  std::atomic<size_t> next_ = 0;
  std::atomic<bool> has_failed_ = false;
  // One element for each problem, written by the worker that took it.
  std::vector<ImageReport> reports_;
  std::vector<std::exception_ptr> failures_;
};

}  // namespace

void WorkspaceRefineOptions::Check() const {
  const auto require = [](bool condition, const char* message) {
    if (!condition) {
      throw Error(ErrorCode::kBadOption, message);
    }
  };
  require(!workspace_path.empty(), "--workspace_path is missing; give it");
  require(device == "auto" || device == "cuda" || device == "cpu",
          "TsarRefine.device: not known; give auto, cuda or cpu");
  require(gpu_index >= -1,
          "TsarRefine.gpu_index: give the number of a GPU, or -1");
  require(num_threads == -1 || num_threads > 0,
          "TsarRefine.num_threads: give at least 1, or -1 for all cores");
  require(cache_size > 0.0 && cache_size <= 1e6,
          "TsarRefine.cache_size: give a positive number of gigabytes");
}

RunSummary RefineWorkspace(const WorkspaceRefineOptions& workspace_options,
                           const RefineOptions& refine_options,
                           Progress& progress,
                           const std::function<bool()>& should_stop) {
  workspace_options.Check();
  refine_options.Check();
  const auto start = std::chrono::steady_clock::now();
  Workspace workspace = OpenWorkspace(workspace_options);
  std::optional<WorkspaceLock> lock;
  const bool in_place = workspace_options.output_path.empty();
  if (in_place) {
    lock.emplace(workspace.Root());
  }
  const WorkspaceOverview overview = CheckWorkspace(workspace);
  const RefineDevices devices =
      CreateRefineDevices(workspace_options,
                          overview,
                          static_cast<int>(workspace.Problems().size()));
  if (!in_place) {
    workspace = CreateOutputWorkspace(
        workspace, workspace_options.output_path, workspace.Type());
    lock.emplace(workspace.Root());
  }

  std::map<std::string, std::string> options =
      RefineOptionsText(refine_options);
  options["device"] = devices.description;
  const std::string options_hash = HashRefineOptions(refine_options);
  WriteManifest(workspace, BuildManifest(workspace, options, options_hash));

  ImageRunner runner(workspace,
                     overview.has_maps,
                     refine_options,
                     devices.cache_num_bytes,
                     should_stop);
  Run run(workspace, runner, progress, should_stop);
  run.Work(devices.devices);

  RunSummary summary;
  summary.workspace_path = workspace.Root();
  summary.type = workspace.Type();
  summary.device = devices.description;
  summary.num_workers = static_cast<int>(devices.devices.size());
  summary.num_images = static_cast<int>(workspace.Problems().size());
  run.AddTo(workspace, &summary);
  summary.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  Manifest manifest = BuildManifest(workspace, options, options_hash);
  run.MarkFailures(&manifest);
  try {
    WriteManifest(workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image says more.
    run.RethrowFailure();
    throw;
  }
  run.RethrowFailure();
  const int num_done = summary.num_refined + summary.num_skipped +
                       static_cast<int>(summary.kept.size());
  if (num_done < summary.num_images) {
    throw Error(ErrorCode::kInterrupted,
                "interrupted after " + std::to_string(num_done) + " of " +
                    std::to_string(summary.num_images) +
                    " images; run the same command again to go on");
  }
  return summary;
}

}  // namespace tsar
