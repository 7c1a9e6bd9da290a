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

// The account of one shard's run over its part of a workspace, kept as
// stereo/tsar/shards/PASS-INDEX-of-COUNT.json until all shards are merged. Each
// is written by the program that works on the shard, and read by all.
struct ShardRecord {
  enum class State {
    kNeeded,     // Begun; not done, or failed, which the note then tells.
    kObserved,   // There is evidence.
    kNothing,    // There is nothing to observe.
    kNotNeeded,  // The image and all whose source it is had been refined.
    kComposed,   // The maps were refined, or kept.
  };
  struct Entry {
    std::string image;
    State state = State::kNeeded;
    // What its view was loaded from, as fingerprints by the names of its parts;
    // only in the pass observe.
    std::map<std::string, std::string> inputs;
    std::string note;
  };

  std::string version;  // Of the program.
  std::string type;     // Of the maps.
  std::map<std::string, std::string> options;
  std::string options_hash;
  std::string images_hash;  // Of the images to refine and their sources.
  std::string pass;
  int index = 0;
  int count = 1;
  bool is_complete = false;
  // What it was run with; no result depends on it.
  std::map<std::string, std::string> runtime;
  // Of the images, those with a mask; nothing where no masks were given.
  std::optional<int64_t> num_masks;
  // The same of depth priors.
  std::optional<int64_t> num_priors;
  std::vector<Entry> images;
};

ContainedPath GetShardFolder(const std::filesystem::path& root);
ContainedPath GetShardPath(const std::filesystem::path& root,
                           const std::string& pass,
                           int index,
                           int count);

// Error kNotFound where there is none, kIo where it cannot be read, kCorrupt
// where the file is not a record or that of another shard.
ShardRecord ReadShardRecord(const std::filesystem::path& path);

// In one step; creates the folder.
void WriteShardRecord(const std::filesystem::path& root,
                      const ShardRecord& record);

// All that there are, by their names.
std::map<std::filesystem::path, ShardRecord> ListShardRecords(
    const std::filesystem::path& root);

// Removes all, and then the folder, in an order that leaves nothing which looks
// like a shard that was not run. Error kIo.
void RemoveShardRecords(const std::filesystem::path& root);

// Error kMismatch, which names the file of `other` and what differs, where the
// two are not parts of the same work: by versions, types of maps, options or
// numbers of shards, or images.
void RequireSameWork(const ShardRecord& own,
                     const ShardRecord& other,
                     const std::filesystem::path& path_of_other);

}  // namespace tsar
