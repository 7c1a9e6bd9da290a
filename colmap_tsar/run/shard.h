// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tsar {

// Which part of the images of a workspace a program works on: one of `count`,
// counted from 0 on, as most schedulers do.
struct Shard {
  int index = 0;
  int count = 1;

  // Throws kBadOption, naming the option "shard", where there is no such part.
  void Check() const;
};

// "0 of 3": for messages.
std::string ToString(const Shard& shard);

// Reads "0/3"; the empty text stands for all images. Throws kBadOption where
// the text is another one, or the index not from 0 to count - 1.
Shard ParseShard(const std::string& text);

// What of the work on a workspace is to be done.
enum class RefinePass {
  kAll,      // Everything, by one program.
  kObserve,  // Of a shard: what each image observes, for its neighbours.
  kModel,    // Of all shards: the planes of the scene, once all were observed.
  kCompose,  // Of a shard: the maps, once there are the planes.
  kMerge,    // What is left once all shards were composed.
};

// "all", "observe", "model", "compose" or "merge".
std::string ToString(RefinePass pass);
// Throws kBadOption.
RefinePass ParsePass(const std::string& text);

// Splits the images of a workspace, given by their places in Problems(), into
// `count` lists in ascending order, of which each takes about the same work;
// some are empty where there are fewer images. Images that are sources of each
// other tend to be in the same list. Depends on nothing but the cameras, the
// images' names and patch-match.cfg.
std::vector<std::vector<size_t>> SplitImages(const Workspace& workspace,
                                             int count);

}  // namespace tsar
