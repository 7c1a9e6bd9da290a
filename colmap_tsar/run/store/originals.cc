// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/originals.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/result_files.h"

#include <algorithm>
#include <string>
#include <vector>

namespace tsar {
namespace {

namespace fs = std::filesystem;

bool IsCompleteMap(const fs::path& path) {
  try {
    ReadMapSize(path);
    return true;
  } catch (const Error& error) {
    if (error.Code() == ErrorCode::kCorrupt ||
        error.Code() == ErrorCode::kNotFound) {
      return false;
    }
    throw;
  }
}

void RequireOriginal(const OriginalMap& map,
                     const ContainedPath& current,
                     const ContainedPath& kept) {
  if (map.is_lost) {
    throw Error::File(ErrorCode::kMismatch,
                      current.string(),
                      "this map has been refined and its original, " +
                          kept.string() + ", is gone or damaged",
                      "run patch_match_stereo again for this image");
  }
  if (map.state == MapState::kUnknown) {
    throw Error::File(
        ErrorCode::kMismatch,
        current.string(),
        "nothing tells whether this map is an original, since its record in "
        "stereo/tsar/records is gone",
        "put the originals back with " + OptionName("restore") +
            " 1, which moves this map to stereo/tsar/superseded");
  }
}

// "stereo/a, stereo/b and stereo/c".
std::string ListResultFolders() {
  std::string list;
  for (size_t i = 0; i < kResultFolders.size(); ++i) {
    if (i > 0) {
      list += i + 1 < kResultFolders.size() ? ", " : " and ";
    }
    list += std::string("stereo/") + kResultFolders[i];
  }
  return list;
}

// written: the files of this program of that name; null without a record.
MapState FindMapState(const fs::path& current,
                      const fs::path& kept,
                      const std::vector<FileId>* written) {
  if (!Exists(current)) {
    return MapState::kMissing;
  }
  const auto is_listed = [&](const auto& is_same) {
    return written != nullptr && std::ranges::any_of(*written, is_same);
  };
  const std::optional<FileId> id = FindFileId(current);
  if (id && is_listed([&](const FileId& other) {
        return id->HasSizeAndTimeOf(other);
      })) {
    return MapState::kRefined;
  }
  if (AreSameFile(current, kept)) {
    return MapState::kOriginal;
  }
  if (!IsCompleteMap(current)) {
    return MapState::kDamaged;
  }
  if (!IsFile(kept)) {
    return MapState::kForeign;
  }
  // A copy of the workspace has other times.
  if (is_listed(
          [&](const FileId& other) { return IsUnchanged(current, other); })) {
    return MapState::kRefined;
  }
  return written == nullptr ? MapState::kUnknown : MapState::kForeign;
}

// name: of the map in the record.
OriginalMap InspectOriginal(const ContainedPath& current,
                            const ContainedPath& kept,
                            const std::optional<ImageRecord>& record,
                            const char* name) {
  std::vector<FileId> written;
  if (record && record->files.contains(name)) {
    written = record->files.at(name);
  }
  OriginalMap map;
  map.state = FindMapState(current, kept, record ? &written : nullptr);
  map.is_kept = IsFile(kept);
  if (map.is_kept && map.state != MapState::kForeign) {
    map.path = kept;
    map.is_lost = map.state == MapState::kRefined && !IsCompleteMap(kept);
  } else if (map.state == MapState::kForeign ||
             map.state == MapState::kDamaged) {
    map.path = current;
  } else {
    map.is_lost = map.state == MapState::kRefined;
  }
  return map;
}

}  // namespace

OriginalMaps::Files FindMapFiles(const MapPaths& paths) {
  return {FindFileId(paths.depth),
          FindFileId(paths.normal),
          FindFileId(paths.original_depth),
          FindFileId(paths.original_normal)};
}

OriginalMaps InspectOriginals(const MapPaths& paths,
                              const std::optional<ImageRecord>& record) {
  OriginalMaps maps;
  maps.files = FindMapFiles(paths);
  maps.depth =
      InspectOriginal(paths.depth, paths.original_depth, record, "depth");
  maps.normal =
      InspectOriginal(paths.normal, paths.original_normal, record, "normal");
  return maps;
}

OriginalMaps FindOriginals(const MapPaths& paths) {
  for (;;) {
    const OriginalMaps::Files before = FindMapFiles(paths);
    OriginalMaps maps = InspectOriginals(paths, ReadRecord(paths.record));
    if (before != FindMapFiles(paths)) {
      continue;  // The record may be that of the files before or after.
    }
    RequireOriginal(maps.depth, paths.depth, paths.original_depth);
    RequireOriginal(maps.normal, paths.normal, paths.original_normal);
    return maps;
  }
}

void RequireNoStrayResults(const MapPaths& paths) {
  for (const ResultFile& result : ResultFiles(paths)) {
    if (IsFile(*result.path) && !Exists(paths.record) &&
        !Exists(paths.original_depth) && !Exists(paths.original_normal)) {
      throw Error::File(
          ErrorCode::kMismatch,
          paths.depth.string(),
          "this map has been refined, as " + result.path->string() +
              " tells, and stereo/tsar, which held the original, is gone",
          "run patch_match_stereo again and delete " + ListResultFolders() +
              "; delete these alone where the depth and normal maps are the "
              "originals");
    }
  }
}

void RequireFileIfThere(const ContainedPath& kept) {
  const std::filesystem::file_status status = SymlinkStatus(kept);
  if (std::filesystem::exists(status) &&
      !std::filesystem::is_regular_file(status)) {
    throw Error::File(ErrorCode::kCorrupt,
                      kept.string(),
                      "stands in the place of an original and is no file",
                      "remove it");
  }
}

ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map) {
  const ContainedPath folder = GetSupersededFolder(map.Root());
  const fs::path name = map.Relative().lexically_relative("stereo");
  ContainedPath target = folder / name;
  for (int number = 2; fs::exists(SymlinkStatus(target)); ++number) {
    target = folder / (name.string() + "." + std::to_string(number));
  }
  CreateFolders(target.Parent());
  RenameFile(path, target);
  return target;
}

void KeepOriginal(const OriginalMap& original,
                  const ContainedPath& current,
                  const ContainedPath& kept) {
  if (original.path.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      current.string(),
                      "there is no map to refine",
                      "run patch_match_stereo for this image");
  }
  if (original.path == kept.Path()) {
    return;
  }
  if (original.is_kept) {
    const ContainedPath moved = Supersede(kept, current);
    Warn(current.string() +
         ": was written after this program's map and counts as the original "
         "now; the one before is " +
         moved.string());
  }
  LinkOrCopyFile(current, kept);
}

std::optional<ContainedPath> PutOriginalBack(const OriginalMap& original,
                                             const ContainedPath& current,
                                             const ContainedPath& kept) {
  std::optional<ContainedPath> superseded;
  if (!original.is_kept) {
    return superseded;
  }
  if (original.state == MapState::kForeign) {
    return Supersede(kept, current);
  }
  if (original.state == MapState::kDamaged ||
      original.state == MapState::kUnknown) {
    superseded = Supersede(current, current);
  }
  CreateFolders(current.Parent());
  RenameFile(kept, current);
  return superseded;
}

}  // namespace tsar
