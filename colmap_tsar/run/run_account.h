// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/refine_run.h"
#include "colmap_tsar/run/shard_entries.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/shard_record.h"

#include <cstddef>
#include <map>
#include <string>

namespace tsar {

// The files that a run writes beside the results of its images, so that the
// user, later runs and other shards know its state.
class RunAccount {
 public:
  virtual ~RunAccount() = default;

  // Called before any image is changed. Throws where the run is not allowed.
  virtual void Begin() = 0;
  // Called before the passes.
  virtual void BeforeObserving() {}
  virtual void BeforeComposing() {}
  // Called when the last pass has ended or had to stop: then throws the failure
  // of an image, or kInterrupted.
  virtual void End(const PipelineOutcome& outcome) = 0;
};

// The runtime settings of a run, by name; no result depends on them.
std::map<std::string, std::string> RuntimeText(const DeviceOptions& options,
                                               const RefineDevices& devices);

// Throws the first failure or, where images are left to be done, kInterrupted
// with the number of images done, out of num_wanted.
void RequireComplete(const PipelineOutcome& outcome, size_t num_wanted);

// The account of a run over all images: stereo/tsar/manifest.json. When all
// images are done, the files that only an unfinished run needs are removed, and
// the links of output workspaces made from this one are renewed.
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

// The account of a shard in one pass: its ShardRecord. A pass begins only if
// the records of other shards belong to the same work and, for composing, if
// all shards have been observed.
class ShardAccount : public RunAccount {
 public:
  // run must outlive this object.
  explicit ShardAccount(const RefineRun& run) : run_(run) {}

  void Begin() override;
  void BeforeObserving() override;
  void BeforeComposing() override;
  void End(const PipelineOutcome& outcome) override;

 private:
  bool IsObserving() const { return run_.options.pass == RefinePass::kObserve; }
  ShardRecord::State ObservedState(size_t index) const;

  const RefineRun& run_;
  ShardRecord record_;
  ObservedShards observed_;  // Only where this pass composes.
};

}  // namespace tsar
