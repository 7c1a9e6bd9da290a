// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/undo_import.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/tools/import/import_record.h"
#include "colmap_tsar/tools/import/import_store.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>

namespace tsar {
namespace {

// Removes empty folders, from `folder` up to below `top`.
void RemoveEmptyFoldersUpTo(ContainedPath folder, const ContainedPath& top) {
  while (folder.Path() != top.Path() && RemoveFolderIfEmpty(folder)) {
    folder = folder.Parent();
  }
}

// Whether an import was killed during a write: its temporary is all that it
// leaves before its first map.
bool HasTemporaries(const std::filesystem::path& root) {
  return std::ranges::any_of(kImportFolders, [&](const char* folder) {
    return !ListFileNames({root, std::filesystem::path("stereo") / folder},
                          AtomicFile::kTemporarySuffix)
                .empty();
  });
}

// Undoes the import of one image's maps of one type.
class ImageUndoer {
 public:
  ImageUndoer(const std::filesystem::path& root,
              const std::string& key,
              RestoreConflicts conflicts,
              UndoResult* result)
      : root_(root), key_(key), conflicts_(conflicts), result_(result) {
    const std::optional<ImportRecord> record =
        ReadImportRecord(GetImportRecordPath(root, key));
    has_record_ = record.has_value();
    record_ = record.value_or(ImportRecord());
    for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
      states_[kind] =
          InspectMap(GetMapPath(root, kind, key),
                     GetFormerPath(root, kind, key),
                     has_record_ ? &record_.written[kind] : nullptr);
      const ContainedPath former = GetFormerPath(root, kind, key);
      is_changed_ =
          is_changed_ ||
          (Exists(former) &&
           IsStoredChanged(states_[kind], former, record_.former[kind]));
    }
  }

  void Run() {
    const std::filesystem::path depth = GetMapPath(root_, kDepthMaps, key_);
    const MapOwner owner = FindOwner(states_[kDepthMaps], states_[kNormalMaps]);
    const bool is_own = owner == MapOwner::kThisProgram || !has_record_ ||
                        record_.is_being_undone;
    const bool puts_back =
        conflicts_ == RestoreConflicts::kOriginal || (is_own && !is_changed_);
    if (puts_back) {
      const bool is_begun = !has_record_ || record_.is_being_undone;
      if (!is_begun) {
        record_.is_being_undone = true;
        WriteImportRecord(GetImportRecordPath(root_, key_), record_);
      }
      for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
        Undo(kind, is_begun);
      }
      RemoveEmptyFoldersUpTo(GetMapPath(root_, kCostMaps, key_).Parent(),
                             ContainedPath(root_, "stereo"));
      ++result_->num_images;
      // The record is removed last, since an interrupted undo still needs it.
      RemoveFile(GetImportRecordPath(root_, key_));
    } else if (conflicts_ == RestoreConflicts::kKeep ||
               (owner == MapOwner::kOtherProgram && !is_changed_)) {
      result_->kept.push_back(depth);
    } else {
      result_->conflicts.push_back(depth);
    }
  }

 private:
  // is_begun: whether a map without a former one was not written by an import.
  void Undo(size_t kind, bool is_begun) {
    const ContainedPath current = GetMapPath(root_, kind, key_);
    const ContainedPath former = GetFormerPath(root_, kind, key_);
    const MapState state = states_[kind];
    const bool has_former = Exists(former);
    if (state == MapState::kWritten && !has_former) {
      RemoveFile(current);
      return;
    }
    // An imported map is all that there is where its former one was changed.
    const bool is_foreign = state != MapState::kMissing &&
                            (state != MapState::kWritten || is_changed_) &&
                            state != MapState::kOriginal;
    // Cost maps written later do not belong to the import.
    if (is_foreign && (has_former || (kind != kCostMaps && !is_begun))) {
      result_->superseded.push_back(Supersede(current, current).Path());
    }
    if (!has_former) {
      return;
    }
    if (IsAnyOf(former, record_.written[kind])) {
      // An import wrote the same bytes. If the undo stopped after the next
      // step, the map would be taken for an imported one.
      record_.written[kind].clear();
      LinkOrCopyFile(former, current);
      WriteImportRecord(GetImportRecordPath(root_, key_), record_);
    }
    CreateFolders(current.Parent());
    RenameFile(former, current);
  }

  const std::filesystem::path& root_;
  const std::string& key_;
  const RestoreConflicts conflicts_;
  UndoResult* const result_;
  bool has_record_ = false;
  ImportRecord record_;
  bool is_changed_ = false;  // Whether a kept map is not the former one.
  std::array<MapState, kImportFolders.size()> states_ = {};
};

}  // namespace

UndoResult UndoImport(const std::filesystem::path& root,
                      RestoreConflicts conflicts) {
  RequireUnrefined(root);
  std::set<std::string> keys;
  keys.merge(ListFileNames(GetImportRecordFolder(root), ".json"));
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    // A killed import may have no record yet.
    keys.merge(ListFileNames(GetFormerFolder(root, kind), ".bin"));
  }
  if (keys.empty() && !HasTemporaries(root)) {
    throw Error::File(ErrorCode::kNotFound,
                      GetImportFolder(root).string(),
                      "nothing was imported into this workspace",
                      "check " + OptionName("workspace_path"));
  }
  UndoResult result;
  // Everything is checked before the first file is changed.
  std::vector<ImageUndoer> images;
  for (const std::string& key : keys) {
    images.emplace_back(root, key, conflicts, &result);
  }
  for (ImageUndoer& image : images) {
    image.Run();
  }
  // This includes the temporaries of images without a record.
  for (const char* folder : kImportFolders) {
    RemoveTemporaries({root, std::filesystem::path("stereo") / folder});
  }
  RemoveTemporaries(GetImportFolder(root));
  RemoveEmptyFolders(GetImportFolder(root));
  return result;
}

}  // namespace tsar
