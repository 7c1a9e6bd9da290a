// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/run_summary.h"

#include <memory>

namespace tsar {

// The files that a run writes beside the results of its images, so that the
// user, later runs and other shards know its state.
class RunAccount {
 public:
  virtual ~RunAccount() = default;

  // Called before any image is changed. Throws where the run is not allowed.
  virtual void Begin() = 0;
  // Called before the last pass.
  virtual void BeforeComposing() {}
  // Called when the last pass has ended or had to stop: then throws the failure
  // of an image, or kInterrupted.
  virtual void End(const PipelineOutcome& outcome) = 0;
};

// The account of a shard in one pass, its ShardRecord, or of a run over all
// images: stereo/tsar/manifest.json. run must outlive it.
std::unique_ptr<RunAccount> MakeRunAccount(const RefineRun& run);

}  // namespace tsar
