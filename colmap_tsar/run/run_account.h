// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/image_catalog.h"
#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/refine_workspace.h"
#include "colmap_tsar/run/scene_model_store.h"
#include "colmap_tsar/run/shard_entries.h"
#include "colmap_tsar/run/store/count_masks.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refine_options.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The parts of a run over images. All outlive the objects they are passed to.
struct RefineRun {
  const WorkspaceRefineOptions& options;
  const RefineOptions& refine_options;
  Workspace& workspace;  // The one that is written.
  // Indices in Problems(), by shard; the run works on those of its own shard.
  const std::vector<std::vector<size_t>>& shards;
  const RefineDevices& devices;
  InputFingerprints& inputs;
  EvidenceStore& evidence;
  const SceneModelStore& model;
  ImageCatalog& catalog;

  const std::vector<size_t>& Images() const {
    return shards[static_cast<size_t>(options.shard.index)];
  }
  // Whether some image of the run has yet to be refined and can be.
  bool IsAnyNeeded() const {
    return std::any_of(Images().begin(), Images().end(), [&](size_t index) {
      return catalog.IsToBeRefined(index);
    });
  }
  // The number of the run's images with a mask; nothing without masks.
  std::optional<int64_t> NumMasks() const {
    return CountMasks(workspace, ReferencesOf(workspace, Images()));
  }
  // The number of the run's images with a depth prior; nothing without priors.
  std::optional<int64_t> NumPriors() const {
    return workspace.Priors().Count(ReferencesOf(workspace, Images()));
  }
  bool HasScenePlanes() const { return NeedsEvidence(refine_options); }
};

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
