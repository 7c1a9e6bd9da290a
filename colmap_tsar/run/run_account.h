// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/run/store/manifest.h"

namespace tsar {

// The account of a run over all images, stereo/tsar/manifest.json, so that the
// user and later runs know its state. Shards leave none before they are merged.
class RunAccount {
 public:
  // run must outlive this object.
  explicit RunAccount(const RefineRun& run) : run_(run) {}

  // Called before any image is changed.
  void Begin();
  // Called when the last pass has ended or had to stop: then throws the failure
  // of an image, or kInterrupted. When all images are done, the files that only
  // an unfinished run needs are removed.
  void End(const PipelineOutcome& outcome);

 private:
  Manifest Build() const;
  void MarkFailures(const PipelineOutcome& outcome, Manifest* manifest) const;

  const RefineRun& run_;
};

}  // namespace tsar
