// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/input_state.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/shard.h"
#include "colmap_tsar/run/store/shard_record.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <exception>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace tsar {

// What the shards of a work tell each other by their records.

// A record without its images and runtime: what all shards of a work must have
// in common, and which one it is.
ShardRecord DescribeShard(const Workspace& workspace,
                          const RefineOptions& options,
                          RefinePass pass,
                          const Shard& shard);

// How many shards the work has, by any of its records; 0 where there are none.
// Throws what RequireSameWork throws, for a program in this pass.
int CountShards(const Workspace& workspace,
                const RefineOptions& options,
                RefinePass pass);

// What it is done with, and on which machine.
std::map<std::string, std::string> ShardRuntime(const DeviceOptions& options,
                                                const RefineDevices& devices);

// Notes that the shard has begun, unless there are shards of other work: then
// throws what RequireSameWork throws, and leaves no trace. A shard that is
// observed has yet to be composed, whatever was done before.
void BeginShard(const std::filesystem::path& root, const ShardRecord& own);

// What the records of the pass observe tell.
struct ObservedShards {
  // By image.
  std::map<int, ShardRecord::State> states;
  std::map<int, InputState> inputs;
  std::set<int> with_evidence;
};

// Reads the records of all shards in one of the passes. Throws Error: what
// RequireSameWork throws, and kNotFound, with the numbers of the shards and the
// first of their notes, where some have not come to its end.
std::vector<ShardRecord> ReadCompleteShards(const std::filesystem::path& root,
                                            const ShardRecord& own,
                                            RefinePass pass);

// Throws what ReadCompleteShards throws. shards: see SplitImages.
ObservedShards ReadObservedShards(
    const Workspace& workspace,
    const ShardRecord& own,
    const std::vector<std::vector<size_t>>& shards);

// Throws kNotFound where the image is a reference that was not observed because
// nobody needed it then.
void RequireObserved(const Workspace& workspace,
                     int image,
                     const ObservedShards& observed);

// Notes the failures of images, in the record's order, in the record. Returns
// whether there are any.
bool NoteFailures(const std::vector<std::exception_ptr>& failures,
                  ShardRecord* record);

}  // namespace tsar
