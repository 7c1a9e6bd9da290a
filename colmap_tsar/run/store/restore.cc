// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/restore.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"

#include <array>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The folders of stereo/tsar that stay after a restoration, if not empty.
constexpr const char* kOriginals = "original";
constexpr const char* kRecords = "records";

constexpr std::array kConflictNames = {
    std::pair(RestoreConflicts::kReport, "report"),
    std::pair(RestoreConflicts::kKeep, "keep"),
    std::pair(RestoreConflicts::kOriginal, "original"),
};

// The restoration of one image's maps of one type.
class ImageRestorer {
 public:
  ImageRestorer(const MapPaths& paths,
                RestoreConflicts conflicts,
                RestoreResult* result)
      : paths_(paths),
        conflicts_(conflicts),
        result_(result),
        // Without a record, or with a broken one, the stored originals count.
        record_(ReadRecordIfValid(paths.record)),
        depth_(Inspect(paths.depth,
                       paths.original_depth,
                       record_ ? &record_->depth.written : nullptr)),
        normal_(Inspect(paths.normal,
                        paths.original_normal,
                        record_ ? &record_->normal.written : nullptr)),
        is_changed_(
            IsStoredChanged(depth_,
                            paths.original_depth,
                            record_ ? record_->depth.original : std::nullopt) ||
            IsStoredChanged(
                normal_,
                paths.original_normal,
                record_ ? record_->normal.original : std::nullopt)) {
    for (const ResultFile& result : ResultFiles(paths_)) {
      RequireNoFolder(result.path->Path());
    }
  }

  void Run() {
    if (record_ && ((!depth_ && IsRefined(paths_.depth, &record_->depth)) ||
                    (!normal_ && IsRefined(paths_.normal, &record_->normal)))) {
      // Without its record, a refined map would count as an original.
      result_->lost.push_back(paths_.depth.Path());
      return;
    }
    if (!depth_ && !normal_) {
      RemoveResults(paths_);
      // The record goes last: an interrupted restoration still needs it.
      RemoveFile(paths_.record);
      return;
    }
    const MapOwner owner = FindOwner(depth_, normal_);
    const bool is_own = owner == MapOwner::kThisProgram ||
                        (owner == MapOwner::kUndecided && !record_);
    if (conflicts_ == RestoreConflicts::kOriginal || (is_own && !is_changed_)) {
      PutBack();
    } else if (conflicts_ == RestoreConflicts::kKeep ||
               (owner == MapOwner::kOtherProgram && !is_changed_)) {
      Keep();
    } else {
      result_->conflicts.push_back(paths_.depth.Path());
    }
  }

 private:
  // The state of a map; nothing where no original is stored.
  static std::optional<MapState> Inspect(
      const ContainedPath& current,
      const ContainedPath& stored,
      const std::vector<WrittenMap>* written) {
    const std::filesystem::file_status status = SymlinkStatus(stored.Path());
    if (std::filesystem::exists(status) &&
        !std::filesystem::is_regular_file(status) &&
        !std::filesystem::is_symlink(status)) {
      throw Error::File(ErrorCode::kCorrupt,
                        stored.string(),
                        "stands in the place of an original and is no file",
                        "remove it");
    }
    return std::filesystem::exists(status)
               ? std::optional(InspectMap(current, stored, written))
               : std::nullopt;
  }

  void PutBack() {
    PutBack(normal_, paths_.normal, paths_.original_normal);
    PutBack(depth_, paths_.depth, paths_.original_depth);
    ++result_->num_restored;
    RemoveResults(paths_);
    RemoveFile(paths_.record);
  }

  void PutBack(std::optional<MapState> state,
               const ContainedPath& current,
               const ContainedPath& stored) {
    if (!state) {
      return;
    }
    CreateFolders(current.Parent());
    const bool is_own =
        state == MapState::kWritten || state == MapState::kOriginal;
    if (state != MapState::kMissing && (!is_own || is_changed_)) {
      result_->superseded.push_back(Supersede(current, current).Path());
    }
    RenameFile(stored, current);
  }

  // Record and originals stay, so that the user can decide otherwise later.
  void Keep() {
    RemoveResults(paths_);
    result_->kept.push_back(paths_.depth.Path());
  }

  const MapPaths paths_;
  const RestoreConflicts conflicts_;
  RestoreResult* const result_;
  const std::optional<ImageRecord> record_;
  const std::optional<MapState> depth_;
  const std::optional<MapState> normal_;
  const bool is_changed_;
};

// The entries of stereo/tsar that runs have left, except the lock and
// superseded maps.
std::vector<Folder::Entry> ListTsarFolder(const std::filesystem::path& root) {
  std::vector<Folder::Entry> entries;
  if (const auto folder = Folder::OpenIfThere(GetTsarFolder(root))) {
    entries = folder->List();
  }
  std::erase_if(entries, [&](const Folder::Entry& entry) {
    return entry.name == WorkspaceLock::kFileName ||
           entry.name == GetSupersededFolder(root).Filename();
  });
  return entries;
}

void RemoveTsarFolder(const std::filesystem::path& root, bool are_all_linked) {
  const ContainedPath tsar = GetTsarFolder(root);
  RemoveTemporaries(tsar / kOriginals);
  RemoveEmptyFolders(tsar / kOriginals);
  const bool needs_notes = Exists(tsar / kOriginals) || !are_all_linked;
  for (const Folder::Entry& entry : ListTsarFolder(root)) {
    const ContainedPath path = tsar / entry.name;
    if (!entry.is_folder) {
      RemoveFile(path);
    } else if (entry.name == kRecords) {
      RemoveTemporaries(path);
      RemoveEmptyFolders(path);
    } else if (entry.name != kOriginals &&
               !(needs_notes && entry.name == kOutputsFolder)) {
      RemoveTree(path);
    }
  }
  RemoveFolderIfEmpty(tsar);
}

}  // namespace

RestoreConflicts ParseRestoreConflicts(const std::string& text) {
  if (const auto conflicts = FindEnumValue(kConflictNames, text)) {
    return *conflicts;
  }
  throw Error(ErrorCode::kBadOption,
              OptionName("restore_conflicts") + ": '" + text +
                  "' is not known; give report, keep or original");
}

RestoreResult Restore(const std::filesystem::path& root,
                      RestoreConflicts conflicts) {
  if (const auto source = ReadOutputMarker(root)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        root.string(),
        "this is an output workspace; its originals are in " + source->string(),
        "delete the output workspace where it is not wanted");
  }
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
  RestoreResult result;
  // All images are checked before the first file is changed.
  std::vector<ImageRestorer> images;
  for (const std::string& key : keys) {
    images.emplace_back(GetMapPaths(root, key), conflicts, &result);
  }
  for (ImageRestorer& image : images) {
    image.Run();
  }
  bool are_all_linked = true;
  result.relinked = RelinkOutputs(root, &are_all_linked);
  const ContainedPath stereo(root, "stereo");
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    RemoveTemporaries(stereo / folder);
  }
  for (const char* folder : kResultFolders) {
    RemoveTemporaries(stereo / folder);
    RemoveEmptyFolders(stereo / folder);
  }
  RemoveTsarFolder(root, are_all_linked);
  return result;
}

}  // namespace tsar
