// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/shard.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tsar {

// The records by which the shards of a work communicate.

// A record without its images and runtime: its shard, and the fields that all
// shards of a work have in common.
ShardRecord DescribeShard(const Workspace& workspace,
                          const RefineOptions& options,
                          RefinePass pass,
                          const Shard& shard);

// The number of shards of the work, from any of its records; 0 where there are
// none. Throws what RequireSameWork throws, for a program in this pass.
int CountShards(const Workspace& workspace,
                const RefineOptions& options,
                RefinePass pass);

// Writes that the shard has begun. Throws what RequireSameWork throws, and
// leaves no trace, where there are shards of other work. A shard that is
// observed has yet to be composed, whatever was done before.
void BeginShard(const std::filesystem::path& root, const ShardRecord& own);

// The content of the records of the pass observe, by image.
struct ObservedShards {
  std::map<int, ShardRecord::State> states;  // By image.
  std::set<int> with_evidence;
};

// Reads the records of all shards in one of the passes. Throws Error: what
// RequireSameWork throws, and kNotFound, with the indices of the shards and the
// first of their notes, where some are not complete.
std::vector<ShardRecord> ReadCompleteShards(const std::filesystem::path& root,
                                            const ShardRecord& own,
                                            RefinePass pass);

// Throws what ReadCompleteShards throws, and kMismatch where the inputs of the
// run have changed since a shard was observed. shards: see SplitImages.
ObservedShards ReadObservedShards(
    const Workspace& workspace,
    const ShardRecord& own,
    const std::vector<std::vector<size_t>>& shards);

// Throws kNotFound where the image is a reference that was not observed because
// it was not needed then.
void RequireObserved(const Workspace& workspace,
                     int image,
                     const ObservedShards& observed);

}  // namespace tsar
