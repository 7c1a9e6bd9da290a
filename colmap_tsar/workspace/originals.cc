// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/originals.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/content_hash.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include <glog/logging.h>

namespace tsar {
namespace {

bool Exists(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

bool HaveSameBytes(const std::filesystem::path& a,
                   const std::filesystem::path& b) {
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error)) {
    return true;
  }
  const uintmax_t size_a = std::filesystem::file_size(a, error);
  const uintmax_t size_b = std::filesystem::file_size(b, error);
  return !error && size_a == size_b && HashFile(a) == HashFile(b);
}

std::filesystem::path Choose(OriginalState state,
                             const std::filesystem::path& current,
                             const std::filesystem::path& stored) {
  return state == OriginalState::kStored ? stored : current;
}

}  // namespace

OriginalState FindOriginal(const std::filesystem::path& current,
                           const std::filesystem::path& stored,
                           const std::vector<uint64_t>& ours,
                           bool has_record) {
  const bool has_current = Exists(current);
  const bool has_stored = Exists(stored);
  if (!has_current) {
    return has_stored ? OriginalState::kStored : OriginalState::kMissing;
  }
  // Hashing reads the whole map; in the first run there is nothing to compare.
  const bool is_ours =
      !ours.empty() &&
      std::find(ours.begin(), ours.end(), HashFile(current)) != ours.end();
  if (!has_stored) {
    if (is_ours) {
      throw Error::File(ErrorCode::kMismatch,
                        current.string(),
                        "this map has been refined and its original, " +
                            stored.string() + ", is gone",
                        "run patch_match_stereo again for this image");
    }
    return OriginalState::kInPlace;
  }
  if (is_ours || HaveSameBytes(current, stored)) {
    return OriginalState::kStored;
  }
  if (!has_record) {
    throw Error::File(ErrorCode::kMismatch,
                      current.string(),
                      "no record tells whether this map or " + stored.string() +
                          " is the original",
                      "delete the other one of the two");
  }
  return OriginalState::kReplaced;
}

OriginalMaps FindOriginals(const MapPaths& paths) {
  const std::optional<ImageRecord> record = ReadRecord(paths.record);
  const ImageRecord known = record.value_or(ImageRecord());
  OriginalMaps maps;
  maps.depth_state = FindOriginal(paths.depth,
                                  paths.original_depth,
                                  known.depth_hashes,
                                  record.has_value());
  maps.normal_state = FindOriginal(paths.normal,
                                   paths.original_normal,
                                   known.normal_hashes,
                                   record.has_value());
  maps.depth = Choose(maps.depth_state, paths.depth, paths.original_depth);
  maps.normal = Choose(maps.normal_state, paths.normal, paths.original_normal);
  if (maps.depth_state == OriginalState::kReplaced ||
      maps.normal_state == OriginalState::kReplaced) {
    LOG(WARNING) << paths.depth.string()
                 << ": the maps are newer than their refinement; taking them "
                    "for the originals in the place of those kept before";
  }
  return maps;
}

}  // namespace tsar
