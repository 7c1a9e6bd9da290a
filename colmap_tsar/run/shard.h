// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tsar {

// One of `count` parts of the images of a workspace, with an index from 0 on,
// as in most schedulers.
struct Shard {
  int index = 0;
  int count = 1;

  // Throws kBadOption, naming the option "shard", for an impossible index.
  void Check() const;
};

// "0 of 3": for messages.
std::string ToString(const Shard& shard);

// Parses "0/3"; an empty text stands for all images. Throws kBadOption for any
// other text and for an index that is not from 0 to count - 1.
Shard ParseShard(const std::string& text);

// The passes of the work on a workspace.
enum class RefinePass {
  kAll,      // Everything, by one program.
  kObserve,  // For a shard: the evidence of its images.
  kModel,    // For all shards: the planes of the scene, once all were observed.
  kCompose,  // For a shard: the maps, once the planes are found.
  kMerge,    // For all shards: the manifest, once all were composed.
};

// "all", "observe", "model", "compose" or "merge".
std::string ToString(RefinePass pass);

// Splits the images of a workspace, given by their indices in Problems(), into
// `count` lists in ascending order, each of about the same work; some are empty
// where there are fewer images. Images that are sources of each other tend to
// be in the same list. The lists depend only on the cameras, the images' names
// and patch-match.cfg.
std::vector<std::vector<size_t>> SplitImages(const Workspace& workspace,
                                             int count);

}  // namespace tsar
