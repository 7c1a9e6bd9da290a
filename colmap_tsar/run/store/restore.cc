// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <algorithm>
#include <set>
#include <string>

namespace tsar {
namespace {

// The folders of stereo/tsar by whose files images are found.
constexpr const char* kOriginals = "original";
constexpr const char* kRecords = "records";

struct RefinedImage {
  MapPaths paths;
  OriginalMaps originals;
};

// Checks all before the first file is changed.
RefinedImage Find(const MapPaths& paths) {
  RequireFileIfThere(paths.original_depth);
  RequireFileIfThere(paths.original_normal);
  for (const ResultFile& result : ResultFiles(paths)) {
    RequireNoFolder(result.path->Path());
  }
  return {paths, InspectOriginals(paths, ReadRecordIfValid(paths.record))};
}

void PutBack(const OriginalMap& original,
             const ContainedPath& current,
             const ContainedPath& kept,
             RestoreResult* result) {
  if (original.is_kept && original.state == MapState::kForeign) {
    result->kept.push_back(current);
  }
  if (const auto superseded = PutOriginalBack(original, current, kept)) {
    result->superseded.push_back(*superseded);
  }
}

void Restore(const RefinedImage& image, RestoreResult* result) {
  const auto& [depth, normal, files] = image.originals;
  const MapPaths& paths = image.paths;
  if (depth.is_lost || normal.is_lost) {
    // Without its record, a refined map would count as an original.
    result->lost.push_back(paths.depth);
    return;
  }
  PutBack(normal, paths.normal, paths.original_normal, result);
  PutBack(depth, paths.depth, paths.original_depth, result);
  result->num_restored += depth.is_kept || normal.is_kept ? 1 : 0;
  RemoveResults(paths);
  // The record goes last: an interrupted restoration still needs it.
  RemoveFile(paths.record);
}

// The entries of stereo/tsar that runs have left, except the lock and
// superseded maps.
std::vector<FolderEntry> ListTsarFolder(const std::filesystem::path& root) {
  std::vector<FolderEntry> entries = ListFolder(GetTsarFolder(root));
  std::erase_if(entries, [&](const FolderEntry& entry) {
    return entry.path.Filename() == WorkspaceLock::kFileName ||
           entry.path.Filename() == GetSupersededFolder(root).Filename();
  });
  return entries;
}

// Removes the temporaries that killed programs left behind, in a folder and all
// below it, but no folders of such names; with_folders: then empty folders,
// too.
void RemoveLeftovers(const ContainedPath& folder, bool with_folders) {
  std::vector<FolderEntry> tree = ListTree(folder);
  std::ranges::reverse(tree);  // Each folder after its content.
  for (const FolderEntry& entry : tree) {
    if (entry.is_folder && with_folders) {
      RemoveFolderIfEmpty(entry.path);
    }
    // As in "NAME.geometric.bin.tsar_tmp".
    const auto type = entry.path.Filename().stem().stem().extension();
    if (!entry.is_folder &&
        entry.path.string().ends_with(AtomicFile::kTemporarySuffix) &&
        (type == ".geometric" || type == ".photometric")) {
      RemoveFile(entry.path);
    }
  }
  if (with_folders) {
    RemoveFolderIfEmpty(folder);
  }
}

void RemoveRemains(const std::filesystem::path& root) {
  const ContainedPath stereo(root, "stereo");
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    RemoveLeftovers(stereo / folder, false);
  }
  for (const char* folder : kResultFolders) {
    RemoveLeftovers(stereo / folder, true);
  }
  for (const FolderEntry& entry : ListTsarFolder(root)) {
    const std::filesystem::path name = entry.path.Filename();
    if (!entry.is_folder) {
      RemoveFile(entry.path);
    } else if (name == kRecords || name == kOriginals) {
      RemoveLeftovers(entry.path, true);
    } else {
      RemoveTree(entry.path);
    }
  }
  RemoveFolderIfEmpty(GetTsarFolder(root));
}

}  // namespace

RestoreResult Restore(const std::filesystem::path& root) {
  const ContainedPath tsar = GetTsarFolder(root);
  // A run that was stopped before its first map leaves no original, but its
  // manifest and its evidence.
  if (ListTsarFolder(root).empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      tsar.string(),
                      "there is nothing to restore",
                      "check " + OptionName("workspace_path"));
  }
  // The keys are those of GetMapPaths.
  std::set<std::string> keys;
  keys.merge(ListFileNames(tsar / kRecords, ".json"));
  keys.merge(ListFileNames(tsar / kOriginals / "depth_maps", ".bin"));
  keys.merge(ListFileNames(tsar / kOriginals / "normal_maps", ".bin"));
  std::vector<RefinedImage> images;
  for (const std::string& key : keys) {
    images.push_back(Find(GetMapPaths(root, key)));
  }
  RestoreResult result;
  for (const RefinedImage& image : images) {
    Restore(image, &result);
  }
  RemoveRemains(root);
  return result;
}

}  // namespace tsar
