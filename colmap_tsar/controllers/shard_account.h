// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/run_account.h"
#include "colmap_tsar/controllers/shard_entries.h"
#include "colmap_tsar/store/shard_record.h"

namespace tsar {

// The account of a shard in one pass: its ShardRecord. A pass begins only where
// the records of other shards are of the same work and, to compose, all of them
// have been observed.
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
  ObservedShards observed_;  // Of all shards, where this pass composes.
};

}  // namespace tsar
