// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_account.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/run/shard_entries.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <unistd.h>

namespace tsar {
namespace {

// The runtime settings of a run, by name; no result depends on them.
std::map<std::string, std::string> RuntimeText(const DeviceOptions& options,
                                               const RefineDevices& devices) {
  TextStream cache_size;
  cache_size << options.cache_size;
  std::map<std::string, std::string> text = {
      {"device", ToString(options.choice)},
      {"gpu_index", GpuIndicesText(options.gpu_indices)},
      {"num_threads", std::to_string(options.num_threads)},
      {"cache_size", cache_size.str()},
      {"used", devices.description},
      {"images_at_a_time", std::to_string(devices.workers.size())}};
  for (const RunSummary::GpuMemory& peak : PeakGpuMemory(devices)) {
    text["peak_bytes of " + peak.gpu] = std::to_string(peak.num_bytes);
  }
  return text;
}

// Throws the first failure or, where images are left to be done, kInterrupted
// with the number of images done, out of num_wanted.
void RequireComplete(const PipelineOutcome& outcome, size_t num_wanted) {
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    const std::string done =
        outcome.num_observed
            ? std::to_string(*outcome.num_observed) + " of " +
                  std::to_string(outcome.reports.size()) +
                  " images were observed, before the first was refined"
            : std::to_string(outcome.NumDone()) + " of " +
                  std::to_string(num_wanted) + " images";
    throw Error(
        ErrorCode::kInterrupted,
        "interrupted after " + done + "; run the same command again to go on");
  }
}

// The account of a run over all images: stereo/tsar/manifest.json. When all
// images are done, the files that only an unfinished run needs are removed.
class ManifestAccount : public RunAccount {
 public:
  explicit ManifestAccount(const RefineRun& run) : run_(run) {}

  void Begin() override;
  void End(const PipelineOutcome& outcome) override;

 private:
  Manifest Build() const;
  void MarkFailures(const PipelineOutcome& outcome, Manifest* manifest) const;

  const RefineRun& run_;
};

void ManifestAccount::Begin() { WriteManifest(run_.workspace, Build()); }

void ManifestAccount::End(const PipelineOutcome& outcome) {
  Manifest manifest = Build();
  MarkFailures(outcome, &manifest);
  try {
    WriteManifest(run_.workspace, manifest);
  } catch (const Error&) {
    // On a full disk the failure of the image is the more helpful message.
    outcome.RethrowFailure();
    throw;
  }
  RequireComplete(outcome, run_.plan.NumListed());
  // The evidence may also be that of a run with other options.
  EvidenceStore::Clear(run_.workspace);
  if (run_.HasScenePlanes()) {
    SceneModelStore::DropLabels(run_.workspace);
  } else {
    SceneModelStore::Remove(run_.workspace);
  }
  RemoveShardRecords(run_.workspace.Root());
}

Manifest ManifestAccount::Build() const {
  Manifest manifest = BuildManifest(run_.workspace,
                                    RefineOptionsText(run_.refine_options),
                                    HashRefineOptions(run_.refine_options));
  manifest.runtime = RuntimeText(run_.options.devices, run_.devices);
  manifest.inputs = run_.inputs.States();
  if (!run_.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] = std::to_string(run_.plan.NumListed());
  }
  NoteMasksAndPriors(run_.NumMasks(), run_.NumPriors(), &manifest);
  return manifest;
}

void ManifestAccount::MarkFailures(const PipelineOutcome& outcome,
                                   Manifest* manifest) const {
  for (size_t i = 0; i < manifest->images.size(); ++i) {
    if (!outcome.failures[i]) {
      continue;
    }
    Manifest::Entry& entry = manifest->images[i];
    entry.note = FailureText(outcome.failures[i]);
    if (run_.plan.HasBeenRefined(i)) {
      // The image was only to be observed, and its maps are as valid as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

using State = ShardRecord::State;

std::string HostName() {
  char name[256] = "";
  gethostname(name, sizeof(name) - 1);
  return name;
}

// The runtime settings of a shard, and its machine.
std::map<std::string, std::string> ShardRuntime(const DeviceOptions& options,
                                                const RefineDevices& devices) {
  std::map<std::string, std::string> runtime = RuntimeText(options, devices);
  runtime["host"] = HostName();
  runtime["process"] = std::to_string(getpid());
  return runtime;
}

// Writes the failures of images, in the record's order, into the record.
// Returns whether there are any.
bool NoteFailures(const std::vector<std::exception_ptr>& failures,
                  ShardRecord* record) {
  bool has_failure = false;
  for (size_t i = 0; i < failures.size(); ++i) {
    if (failures[i]) {
      has_failure = true;
      record->images[i].note = FailureText(failures[i]);
    }
  }
  return has_failure;
}

// The account of a shard in one pass: its ShardRecord. A pass begins only if
// the records of other shards belong to the same work and, for composing, if
// all shards have been observed.
class ShardAccount : public RunAccount {
 public:
  explicit ShardAccount(const RefineRun& run) : run_(run) {}

  void Begin() override;
  void BeforeComposing() override;
  void End(const PipelineOutcome& outcome) override;

 private:
  bool IsObserving() const { return run_.options.pass == RefinePass::kObserve; }
  State ObservedState(size_t index) const;

  const RefineRun& run_;
  ShardRecord record_;
  ObservedShards observed_;  // Only where this pass composes.
};

void ShardAccount::Begin() {
  record_ = DescribeShard(run_.workspace,
                          run_.refine_options,
                          run_.options.pass,
                          run_.options.shard);
  record_.runtime = ShardRuntime(run_.options.devices, run_.devices);
  record_.inputs = run_.inputs.OfRun();
  record_.num_masks = run_.NumMasks();
  record_.num_priors = run_.NumPriors();
  for (const size_t index : run_.Images()) {
    record_.images.push_back({run_.plan.Name(index), State::kNeeded, ""});
  }
  if (!IsObserving()) {
    observed_ = ReadObservedShards(run_.workspace, record_, run_.shards);
  }
  BeginShard(run_.workspace.Root(), record_);
}

void ShardAccount::BeforeComposing() {
  if (!run_.HasScenePlanes()) {
    return;
  }
  run_.evidence.Expect(observed_.with_evidence);
  for (const size_t index : run_.Images()) {
    if (run_.plan.CanRefine(index) && !run_.plan.HasBeenRefined(index)) {
      for (const int view : run_.plan.SourcesAndReference(index)) {
        RequireObserved(run_.workspace, view, observed_);
        run_.evidence.IsCurrent(view);
      }
    }
  }
}

void ShardAccount::End(const PipelineOutcome& outcome) {
  if (NoteFailures(outcome.failures, &record_)) {
    try {
      WriteShardRecord(run_.workspace.Root(), record_);
    } catch (const Error&) {
      // On a full disk the failure of the image is the more helpful message.
    }
  }
  RequireComplete(outcome, run_.Images().size());
  for (size_t i = 0; i < run_.Images().size(); ++i) {
    record_.images[i].state =
        IsObserving() ? ObservedState(run_.Images()[i]) : State::kComposed;
  }
  record_.is_complete = true;
  WriteShardRecord(run_.workspace.Root(), record_);
}

State ShardAccount::ObservedState(size_t index) const {
  if (!run_.HasScenePlanes() || !run_.plan.CanRefine(index)) {
    return State::kNothing;
  }
  if (!run_.plan.IsNeeded(index)) {
    return State::kNotNeeded;
  }
  return run_.evidence.IsCurrent(run_.plan.Reference(index)) ? State::kObserved
                                                             : State::kNothing;
}

}  // namespace

std::unique_ptr<RunAccount> MakeRunAccount(const RefineRun& run) {
  if (run.options.pass == RefinePass::kAll) {
    return std::make_unique<ManifestAccount>(run);
  }
  return std::make_unique<ShardAccount>(run);
}

}  // namespace tsar
