// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/restore.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/map_paths.h"
#include "colmap_tsar/workspace/originals.h"
#include "colmap_tsar/workspace/output_workspace.h"
#include "colmap_tsar/workspace/record.h"
#include "colmap_tsar/workspace/workspace_lock.h"

#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include <glog/logging.h>

namespace tsar {
namespace {

// The files below a folder whose names end in `suffix`.
std::vector<std::filesystem::path> ListFiles(
    const std::filesystem::path& folder, const std::string& suffix) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(folder, error), end;
       !error && it != end;
       it.increment(error)) {
    if (!it->is_directory() && it->path().string().ends_with(suffix)) {
      files.push_back(it->path());
    }
  }
  return files;
}

// Adds the keys (see GetMapPaths) of the files below a folder.
void AddKeys(const std::filesystem::path& folder,
             const std::string& suffix,
             std::set<std::string>* keys) {
  for (const std::filesystem::path& file : ListFiles(folder, suffix)) {
    const std::string name = file.lexically_relative(folder).string();
    keys->insert(name.substr(0, name.size() - suffix.size()));
  }
}

// Without a record, or with a broken one, the stored originals count.
std::optional<ImageRecord> ReadRecordIfValid(
    const std::filesystem::path& path) {
  try {
    return ReadRecord(path);
  } catch (const Error& error) {
    LOG(WARNING) << error.what();
    return std::nullopt;
  }
}

enum class MapResult { kNone, kRestored, kNewer };

MapResult RestoreMap(const std::filesystem::path& current,
                     const std::filesystem::path& stored,
                     const std::vector<uint64_t>* ours) {
  std::error_code error;
  if (!std::filesystem::exists(stored, error)) {
    return MapResult::kNone;
  }
  if (ours != nullptr &&
      FindOriginal(current, stored, *ours, true) == OriginalState::kReplaced) {
    LOG(WARNING) << current.string()
                 << ": this map is newer than its refinement; it stays, and "
                    "the original kept before is dropped";
    RemoveFile(stored);
    return MapResult::kNewer;
  }
  CreateFolders(current.parent_path());
  RenameFile(stored, current);
  return MapResult::kRestored;
}

void RestoreImage(const MapPaths& paths, RestoreResult* result) {
  const std::optional<ImageRecord> record = ReadRecordIfValid(paths.record);
  const MapResult normal =
      RestoreMap(paths.normal,
                 paths.original_normal,
                 record ? &record->normal_hashes : nullptr);
  const MapResult depth = RestoreMap(paths.depth,
                                     paths.original_depth,
                                     record ? &record->depth_hashes : nullptr);
  const auto either = [&](MapResult value) {
    return depth == value || normal == value ? 1 : 0;
  };
  result->num_restored += either(MapResult::kRestored);
  result->num_newer += either(MapResult::kNewer);
  RemoveFile(paths.confidence);
  RemoveFile(paths.provenance);
  // Last: an interrupted restoration still needs it.
  RemoveFile(paths.record);
}

// Removes the folders that hold nothing, from the innermost out.
void RemoveEmptyFolders(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> folders;
  for (std::filesystem::recursive_directory_iterator it(folder, error), end;
       !error && it != end;
       it.increment(error)) {
    if (it->is_directory() && !it->is_symlink()) {
      folders.push_back(it->path());
    }
  }
  for (auto it = folders.rbegin(); it != folders.rend(); ++it) {
    // Fails, as it should, where something is left.
    std::filesystem::remove(*it, error);
  }
  std::filesystem::remove(folder, error);
}

// What lies directly in stereo/tsar, apart from the lock.
std::vector<std::filesystem::path> ListTsarFolder(
    const std::filesystem::path& root) {
  std::error_code error;
  std::vector<std::filesystem::path> entries;
  for (const auto& entry :
       std::filesystem::directory_iterator(GetTsarFolder(root), error)) {
    if (entry.path().filename() != WorkspaceLock::kFileName) {
      entries.push_back(entry.path());
    }
  }
  return entries;
}

void RemoveTsarFolder(const std::filesystem::path& root) {
  std::error_code error;
  for (const std::filesystem::path& entry : ListTsarFolder(root)) {
    std::filesystem::remove_all(entry, error);
  }
  std::filesystem::remove(GetTsarFolder(root), error);
}

}  // namespace

RestoreResult Restore(const std::filesystem::path& root) {
  if (const auto source = ReadOutputMarker(root)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        root.string(),
        "this is an output workspace; its originals are in " + source->string(),
        "delete the output workspace where it is not wanted");
  }
  const std::filesystem::path tsar = GetTsarFolder(root);
  // A run that was stopped before its first map leaves no original, but its
  // manifest and what it observed.
  if (ListTsarFolder(root).empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      tsar.string(),
                      "there is nothing to restore",
                      "check --workspace_path");
  }
  std::set<std::string> keys;
  AddKeys(tsar / "records", ".json", &keys);
  AddKeys(tsar / "original" / "depth_maps", ".bin", &keys);
  AddKeys(tsar / "original" / "normal_maps", ".bin", &keys);
  RestoreResult result;
  for (const std::string& key : keys) {
    RestoreImage(GetMapPaths(root, key), &result);
  }
  const std::filesystem::path stereo = root / "stereo";
  for (const char* folder :
       {"depth_maps", "normal_maps", "confidence_maps", "provenance_maps"}) {
    RemoveTemporaries(stereo / folder);
  }
  RemoveEmptyFolders(stereo / "confidence_maps");
  RemoveEmptyFolders(stereo / "provenance_maps");
  RemoveTsarFolder(root);
  return result;
}

}  // namespace tsar
