// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/run_account.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/failure.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/view/refine_option_list.h"

namespace tsar {
namespace {

bool WasRefinedBefore(RefinePlan& plan, size_t index) {
  try {
    return plan.HasBeenRefined(index);
  } catch (const Error&) {
    // The failure may be that this cannot be found out.
    return false;
  }
}

}  // namespace

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
  if (run_.options.output_path.empty() && !run_.workspace.IsOutput()) {
    // Kept images got their maps back from the folder that links lead to.
    bool are_all_linked = true;
    RelinkOutputs(run_.workspace.Root(), &are_all_linked);
  }
}

Manifest ManifestAccount::Build() const {
  Manifest manifest = BuildManifest(run_.workspace,
                                    RefineOptionsText(run_.refine_options),
                                    HashRefineOptions(run_.refine_options));
  manifest.runtime = RuntimeText(run_.options.devices, run_.devices);
  if (!run_.options.image_list_path.empty()) {
    manifest.runtime["listed_images"] = std::to_string(run_.plan.NumListed());
  }
  NoteMasks(run_.NumMasks(), &manifest);
  NotePriors(run_.NumPriors(), &manifest);
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
    if (WasRefinedBefore(run_.plan, i)) {
      // The image was only to be observed, and its maps are as valid as before.
      entry.note = "cannot be observed for other images: " + entry.note;
    } else {
      entry.status = ImageStatus::kFailed;
    }
  }
}

using State = ShardRecord::State;

void ShardAccount::Begin() {
  record_ = DescribeShard(run_.workspace,
                          run_.refine_options,
                          run_.options.pass,
                          run_.options.shard);
  record_.runtime = ShardRuntime(run_.options.devices, run_.devices);
  record_.num_masks = run_.NumMasks();
  record_.num_priors = run_.NumPriors();
  for (const size_t index : run_.Images()) {
    record_.images.push_back({run_.plan.Name(index), State::kNeeded, {}, ""});
  }
  if (!IsObserving()) {
    observed_ = ReadObservedShards(run_.workspace, record_, run_.shards);
  }
  BeginShard(run_.workspace.Root(), record_);
}

void ShardAccount::BeforeObserving() {
  for (size_t i = 0; i < run_.Images().size(); ++i) {
    const int reference = run_.plan.Reference(run_.Images()[i]);
    if (!run_.HasScenePlanes() && !run_.workspace.IsOutput() &&
        run_.plan.HasMaps(reference)) {
      // The other shards read the original, whatever becomes of the maps.
      StoreOriginals(run_.workspace, reference);
    }
    record_.images[i].inputs = run_.inputs.OfView(reference);
  }
}

void ShardAccount::BeforeComposing() {
  std::vector<int> own;
  for (const size_t index : run_.Images()) {
    own.push_back(run_.plan.Reference(index));
  }
  run_.inputs.Expect(observed_.inputs, own);
  for (const int image : own) {
    run_.inputs.OfView(image);
  }
  if (!run_.HasScenePlanes()) {
    if (!run_.workspace.IsOutput()) {
      run_.workspace.TrustStoredOriginals();
    }
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

}  // namespace tsar
