// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/shard_account.h"

#include "colmap_tsar/store/write_back.h"

#include <vector>

namespace tsar {

using State = ShardRecord::State;

void ShardAccount::Begin() {
  record_ = DescribeShard(run_.workspace,
                          run_.refine_options,
                          run_.options.pass,
                          run_.options.shard);
  record_.runtime = ShardRuntime(run_.options.devices, run_.devices);
  record_.num_masks = run_.NumMasks();
  for (const size_t index : run_.Images()) {
    record_.images.push_back(
        {run_.catalogue.Name(run_.catalogue.Reference(index)),
         State::kNeeded,
         {},
         ""});
  }
  if (!IsObserving()) {
    observed_ = ReadObservedShards(run_.workspace, record_, run_.shards);
  }
  BeginShard(run_.workspace.Root(), record_);
}

void ShardAccount::BeforeObserving() {
  for (size_t i = 0; i < run_.Images().size(); ++i) {
    const int reference = run_.catalogue.Reference(run_.Images()[i]);
    if (!run_.HasScenePlanes() && !run_.workspace.IsOutput() &&
        run_.catalogue.HasMaps(reference)) {
      // The other shards will read it, whatever becomes of the maps.
      StoreOriginals(run_.workspace, reference);
    }
    record_.images[i].inputs = run_.inputs.OfView(reference);
  }
}

void ShardAccount::BeforeComposing() {
  std::vector<int> own;
  for (const size_t index : run_.Images()) {
    own.push_back(run_.catalogue.Reference(index));
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
    if (run_.catalogue.CanRefine(index) &&
        !run_.catalogue.HasBeenRefined(index)) {
      for (const int view : run_.catalogue.SourcesAndReference(index)) {
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
      // On a full disk the failure of the image says more.
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
  if (!run_.HasScenePlanes() || !run_.catalogue.CanRefine(index)) {
    return State::kNothing;
  }
  if (!run_.catalogue.IsNeeded(index)) {
    return State::kNotNeeded;
  }
  return run_.evidence.IsCurrent(run_.catalogue.Reference(index))
             ? State::kObserved
             : State::kNothing;
}

}  // namespace tsar
