// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/run_account.h"
#include "colmap_tsar/store/manifest.h"

namespace tsar {

// The account of a run over all images: stereo/tsar/manifest.json. When
// everything is done, what only an unfinished run needs is removed, and output
// workspaces made of this one get their links again.
class ManifestAccount : public RunAccount {
 public:
  // run must outlive this object.
  explicit ManifestAccount(const RefineRun& run) : run_(run) {}

  void Begin() override;
  void End(const PipelineOutcome& outcome) override;

 private:
  Manifest Build() const;
  void MarkFailures(const PipelineOutcome& outcome, Manifest* manifest) const;

  const RefineRun& run_;
};

}  // namespace tsar
