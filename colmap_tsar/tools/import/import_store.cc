// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_store.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/restore.h"
#include "colmap_tsar/tools/import/import_record.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <utility>

namespace tsar {
namespace {

// Whether a file exists that no import wrote.
bool IsForeignMap(const std::filesystem::path& path,
                  const std::vector<WrittenMap>& ours) {
  return Exists(path) && !IsAnyOf(path, ours);
}

void SupersedeAndWarn(const ContainedPath& path, const ContainedPath& map) {
  const ContainedPath moved = Supersede(path, map);
  Warn(map.string() + ": what was kept or stood there is now " +
       moved.string());
}

// The state of the former map; nullopt if there is none.
std::optional<MapState> InspectKept(const ImportPaths& paths,
                                    size_t kind,
                                    const ImportRecord& record) {
  if (!Exists(paths.former[kind])) {
    return std::nullopt;
  }
  return InspectMap(
      paths.maps[kind], paths.former[kind], &record.written[kind]);
}

// Keeps the maps that an import will replace, unless imports wrote them, and
// describes them in the record. Throws kMismatch if their source is unknown.
void KeepFormer(const ImportPaths& paths,
                const ImportRecord& record,
                ImportRecord* next) {
  std::array<std::optional<MapState>, kImportFolders.size()> states;
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    states[kind] = InspectKept(paths, kind, record);
  }
  const MapOwner owner = FindOwner(states[kDepthMaps], states[kNormalMaps]);
  const bool has_former = states[kDepthMaps] || states[kNormalMaps];
  if (has_former && owner == MapOwner::kUndecided) {
    throw Error::File(
        ErrorCode::kMismatch,
        paths.maps[kDepthMaps].string(),
        "nothing tells whether this map and its normals, or those "
        "that an import has kept, are the former ones",
        "decide by tsar_import " + OptionName("restore") + " 1 with " +
            OptionName("restore_conflicts") + " original or keep");
  }
  const bool is_replaced = has_former && owner == MapOwner::kOtherProgram;
  // All earlier former maps are removed before the first current one is kept,
  // so that the two sets are never mixed.
  for (size_t kind = 0; is_replaced && kind < kImportFolders.size(); ++kind) {
    if (states[kind]) {
      SupersedeAndWarn(paths.former[kind], paths.maps[kind]);
    }
  }
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    const ContainedPath& current = paths.maps[kind];
    const ContainedPath& former = paths.former[kind];
    if (is_replaced) {
      next->former[kind].reset();
    }
    if (!IsForeignMap(current, record.written[kind])) {
      continue;
    }
    if (states[kind] && !is_replaced) {
      if (states[kind] != MapState::kOriginal) {
        SupersedeAndWarn(current, current);  // An edited or damaged import.
        continue;
      }
    } else {
      LinkOrCopyFile(current, former);
    }
    next->former[kind] = WrittenMap{HashFile(former), 0, {}};
  }
}

// Removes empty folders, from `folder` up to below `top`.
void RemoveEmptyFoldersUpTo(ContainedPath folder, const ContainedPath& top) {
  while (folder.Path() != top.Path() && RemoveFolderIfEmpty(folder)) {
    folder = folder.Parent();
  }
}

// Whether an import was killed in a write: it leaves its temporary.
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
      : stereo_(root, "stereo"),
        paths_(GetImportPaths(root, key)),
        conflicts_(conflicts),
        result_(result) {
    const std::optional<ImportRecord> record = ReadImportRecord(paths_.record);
    has_record_ = record.has_value();
    record_ = record.value_or(ImportRecord());
    for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
      const ContainedPath& former = paths_.former[kind];
      states_[kind] =
          InspectMap(paths_.maps[kind],
                     former,
                     has_record_ ? &record_.written[kind] : nullptr);
      is_changed_ =
          is_changed_ ||
          (Exists(former) &&
           IsStoredChanged(states_[kind], former, record_.former[kind]));
    }
  }

  void Run() {
    const std::filesystem::path depth = paths_.maps[kDepthMaps];
    const MapOwner owner = FindOwner(states_[kDepthMaps], states_[kNormalMaps]);
    const bool is_own = owner == MapOwner::kThisProgram || !has_record_ ||
                        record_.is_being_undone;
    const bool puts_back =
        conflicts_ == RestoreConflicts::kOriginal || (is_own && !is_changed_);
    if (puts_back) {
      const bool is_begun = !has_record_ || record_.is_being_undone;
      if (!is_begun) {
        record_.is_being_undone = true;
        WriteImportRecord(paths_.record, record_);
      }
      for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
        Undo(kind, is_begun);
      }
      RemoveEmptyFoldersUpTo(paths_.maps[kCostMaps].Parent(), stereo_);
      ++result_->num_images;
      // The record is removed last, since an interrupted undo still needs it.
      RemoveFile(paths_.record);
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
    const ContainedPath& current = paths_.maps[kind];
    const ContainedPath& former = paths_.former[kind];
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
      WriteImportRecord(paths_.record, record_);
    }
    CreateFolders(current.Parent());
    RenameFile(former, current);
  }

  const ContainedPath stereo_;
  const ImportPaths paths_;
  const RestoreConflicts conflicts_;
  UndoResult* const result_;
  bool has_record_ = false;
  ImportRecord record_;
  bool is_changed_ = false;  // Whether a kept map is not the former one.
  std::array<MapState, kImportFolders.size()> states_ = {};
};

}  // namespace

void RequireUnrefined(const std::filesystem::path& root) {
  if (const auto source = ReadOutputMarker(root)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        root.string(),
        "tsar_refine made this workspace from " + source->string(),
        "import into that one");
  }
  if (HasRunState(root)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        GetTsarFolder(root).string(),
        "tsar_refine has worked on this workspace",
        "undo that first with tsar_refine " + OptionName("restore") + " 1");
  }
}

void RequireNoForeignMaps(const std::filesystem::path& root,
                          const std::string& image_name,
                          MapType type) {
  const ImportPaths paths = GetImportPaths(root, image_name, type);
  const ImportRecord record =
      ReadImportRecord(paths.record).value_or(ImportRecord());
  for (const size_t kind : {kDepthMaps, kNormalMaps}) {
    const ContainedPath& path = paths.maps[kind];
    if (IsForeignMap(path, record.written[kind])) {
      throw Error::File(
          ErrorCode::kUnsupported,
          path.string(),
          "the image has a map of this type already",
          "give " + OptionName("overwrite") +
              " 1 to replace such maps (tsar_import " + OptionName("restore") +
              " 1 puts them back), or another " + OptionName("output_type"));
    }
  }
}

void RequireNoFolders(const std::filesystem::path& root,
                      const std::string& image_name,
                      MapType type) {
  const ImportPaths paths = GetImportPaths(root, image_name, type);
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    RequireNoFolder(paths.maps[kind].Path());
    RequireNoFolder(paths.former[kind].Path());
  }
  RequireNoFolder(paths.record.Path());
}

void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps) {
  const ImportPaths paths = GetImportPaths(root, image_name, type);
  const ImportRecord earlier =
      ReadImportRecord(paths.record).value_or(ImportRecord());
  ImportRecord record = earlier;
  record.is_being_undone = false;
  std::vector<AtomicFile> files;
  const bool has_cost = !maps.cost.values.empty();
  for (size_t kind = 0; kind < (has_cost ? 3u : 2u); ++kind) {
    const ContainedPath& path = paths.maps[kind];
    CreateFolders(path.Parent());
    AtomicFile& file = files.emplace_back(path);
    WrittenMap written = kind == kDepthMaps ? PutDepthMap(maps.depth, &file)
                         : kind == kNormalMaps
                             ? PutNormalMap(maps.normal, &file)
                             : PutPlanarMap(maps.cost, &file);
    file.Prepare();
    written.time = file.Time();
    std::vector<WrittenMap>& known = record.written[kind];
    if (std::ranges::find(known, written.hash, &WrittenMap::hash) ==
        known.end()) {
      known.push_back(std::move(written));
    }
  }
  KeepFormer(paths, earlier, &record);
  WriteImportRecord(paths.record, record);
  for (AtomicFile& file : files) {
    file.Commit();
  }
  if (!has_cost) {
    // The cost map belongs to other depths.
    RemoveFile(paths.maps[kCostMaps]);
  }
}

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
