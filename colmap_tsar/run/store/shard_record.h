// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The account of one shard's run over its part of a workspace, stored as
// stereo/tsar/shards/PASS-INDEX-of-COUNT.json until all shards are merged. The
// program that works on the shard writes it, all programs read it.
struct ShardRecord {
  enum class State {
    kNeeded,     // Begun; unfinished, or failed as the note tells.
    kObserved,   // There is evidence.
    kNothing,    // There is nothing to observe.
    kNotNeeded,  // The image and all that use it had been refined.
    kComposed,   // The maps were refined, or kept.
  };
  struct Entry {
    std::string image;
    State state = State::kNeeded;
    std::string note;
  };

  std::string version;  // The program's version.
  std::string type;     // The type of the maps.
  std::map<std::string, std::string> options;
  std::string options_hash;
  std::string images_hash;  // A hash of the images to refine and their sources.
  // The fingerprint of the inputs of the run, see InputFingerprints.
  std::string inputs;
  std::string pass;
  int index = 0;
  int count = 1;
  bool is_complete = false;
  // The runtime settings of the run; no result depends on them.
  std::map<std::string, std::string> runtime;
  // The number of images with a mask; nothing where no masks were given.
  std::optional<int64_t> num_masks;
  // The number of images with a depth prior; nothing without priors.
  std::optional<int64_t> num_priors;
  std::vector<Entry> images;
};

ContainedPath GetShardFolder(const std::filesystem::path& root);
ContainedPath GetShardPath(const std::filesystem::path& root,
                           const std::string& pass,
                           int index,
                           int count);

// Error kNotFound where there is no record, kIo where it cannot be read,
// kCorrupt where the file is not a record or that of another shard.
ShardRecord ReadShardRecord(const std::filesystem::path& path);

// Writes the record atomically; creates the folder.
void WriteShardRecord(const std::filesystem::path& root,
                      const ShardRecord& record);

// All existing records, by their paths.
std::map<std::filesystem::path, ShardRecord> ListShardRecords(
    const std::filesystem::path& root);

// Removes all records, then the folder, in an order in which no intermediate
// state looks like a shard that was not run. Error kIo.
void RemoveShardRecords(const std::filesystem::path& root);

// Error kMismatch, naming the file of `other` and the difference, where the two
// records are not of the same work: other versions, types of maps, options,
// numbers of shards, or images.
void RequireSameWork(const ShardRecord& own,
                     const ShardRecord& other,
                     const std::filesystem::path& path_of_other);

}  // namespace tsar
