// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/workspace/map_paths.h"
#include "colmap_tsar/workspace/record.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tsar {

// Where the map that COLMAP wrote is to be found.
enum class OriginalState {
  kMissing,   // There is no map at all.
  kInPlace,   // Under its own name; nothing is stored.
  kStored,    // In stereo/tsar/original; ours, or the same bytes, in its place.
  kReplaced,  // Under its own name: COLMAP wrote it anew, the stored is stale.
};

// Looks at a map and at its stored original. record: that of the image, or
// nullptr; its hashes of this kind of map are `ours`. Throws Error kMismatch
// where the original is lost or where nothing tells which file it is.
OriginalState FindOriginal(const std::filesystem::path& current,
                           const std::filesystem::path& stored,
                           const std::vector<uint64_t>& ours,
                           bool has_record);

// The originals of an image's maps.
struct OriginalMaps {
  OriginalState depth_state = OriginalState::kMissing;
  OriginalState normal_state = OriginalState::kMissing;
  std::filesystem::path depth;
  std::filesystem::path normal;
};

// Looks at both maps of an image; logs a warning for stale stored originals.
OriginalMaps FindOriginals(const MapPaths& paths);

}  // namespace tsar
