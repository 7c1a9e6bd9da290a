// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/run_account.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/view/refine_observer.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// One run of tsar_refine over the images of a shard, in every pass but kModel
// and kMerge. A run over all images is that of shard 0 of 1.
class RefineController {
 public:
  // All references, and the observer where there is one, must outlive this
  // object. Opens and locks the workspace.
  RefineController(const WorkspaceRefineOptions& options,
                   const RefineOptions& refine_options,
                   Progress& progress,
                   const std::function<bool()>& should_stop,
                   RefineObserver* observer);

  // See RefineWorkspace.
  RunSummary Run();

 private:
  bool IsShard() const { return options_.pass != RefinePass::kAll; }
  const std::vector<size_t>& Images() const {
    return shards_[static_cast<size_t>(options_.shard.index)];
  }
  void Lock();
  std::vector<std::string> FusionObstacles() const;
  // Makes the workspace at output_path and continues with it.
  void OpenOutput();
  // Returns the outcome of the last pass of this run.
  PipelineOutcome RunPasses(const RefineRun& run, RunAccount& account);
  RunSummary Summarize(const RefineRun& run,
                       const PipelineOutcome& outcome) const;

  const Stopwatch stopwatch_;
  const OpenCvWithoutThreads opencv_without_threads_;
  const WorkspaceRefineOptions& options_;
  const RefineOptions& refine_options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  RefineObserver* const observer_;
  Workspace workspace_;
  std::optional<WorkspaceLock> lock_;
  std::optional<WorkspaceLock> input_lock_;
  // Indices in Problems(), by shard.
  std::vector<std::vector<size_t>> shards_;
  WorkspaceOverview overview_;
  RefineDevices devices_;
};

}  // namespace tsar
