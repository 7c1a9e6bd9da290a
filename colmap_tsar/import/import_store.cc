// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/import_store.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/store/map_state.h"
#include "colmap_tsar/store/output_workspace.h"
#include "colmap_tsar/store/superseded.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

// The three kinds of maps, by the names of their folders.
constexpr std::array<const char*, 3> kFolders = {
    "depth_maps", "normal_maps", "cost_maps"};

constexpr size_t kDepth = 0;
constexpr size_t kNormal = 1;
constexpr size_t kCost = 2;

// What is known of an image's imports.
struct Record {
  // The maps that they may have left under a name, for each of kFolders.
  std::array<std::vector<WrittenMap>, kFolders.size()> written;
  // Whether undoing them has begun: what has no former map then may have been
  // put back.
  bool is_being_undone = false;
};

std::string KeyOf(const std::string& image_name, MapType type) {
  return image_name + "." + ToString(type);
}

ContainedPath CurrentPath(const std::filesystem::path& root,
                          size_t kind,
                          const std::string& key) {
  return {root,
          std::filesystem::path("stereo") / kFolders[kind] / (key + ".bin")};
}

ContainedPath FormerFolder(const std::filesystem::path& root, size_t kind) {
  return GetImportFolder(root) / "former" / kFolders[kind];
}

ContainedPath FormerPath(const std::filesystem::path& root,
                         size_t kind,
                         const std::string& key) {
  return FormerFolder(root, kind) / (key + ".bin");
}

ContainedPath RecordFolder(const std::filesystem::path& root) {
  return GetImportFolder(root) / "records";
}

ContainedPath RecordPath(const std::filesystem::path& root,
                         const std::string& key) {
  return RecordFolder(root) / (key + ".json");
}

bool Exists(const std::filesystem::path& path) {
  // What cannot be looked at may be there.
  std::error_code error;
  return std::filesystem::status(path, error).type() !=
         std::filesystem::file_type::not_found;
}

// Nothing where there is no record.
std::optional<Record> ReadImportRecord(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.IsMissing()) {
    return std::nullopt;
  }
  Record record;
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    for (size_t kind = 0; kind < kFolders.size(); ++kind) {
      for (const nlohmann::json& entry : json.at(kFolders[kind])) {
        record.written[kind].push_back(
            WrittenMapFromText(entry.get<std::string>()));
      }
    }
    record.is_being_undone = json.value("is_being_undone", false);
    return record;
  } catch (const nlohmann::json::exception&) {
  } catch (const std::logic_error&) {
    // A map that is none.
  }
  throw Error::File(ErrorCode::kCorrupt,
                    path.string(),
                    "not a record of this program",
                    "look at the maps in stereo/tsar_import/former, move them "
                    "back by hand and delete stereo/tsar_import");
}

void WriteImportRecord(const ContainedPath& path, const Record& record) {
  nlohmann::json json;
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    nlohmann::json list = nlohmann::json::array();
    for (const WrittenMap& map : record.written[kind]) {
      list.push_back(ToText(map));
    }
    json[kFolders[kind]] = std::move(list);
  }
  json["is_being_undone"] = record.is_being_undone;
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream() << json.dump(2) << "\n";
  file.Commit();
}

// Whether a file is there that no import has written.
bool IsForeign(const std::filesystem::path& path,
               const std::vector<WrittenMap>& ours) {
  return Exists(path) && !IsAnyOf(path, ours);
}

// Removes folders that hold nothing, from `folder` up to below `top`.
void RemoveEmptyFoldersUpTo(ContainedPath folder, const ContainedPath& top) {
  while (folder.Path() != top.Path() && RemoveFolderIfEmpty(folder)) {
    folder = folder.Parent();
  }
}

void SupersedeAndWarn(const ContainedPath& path, const ContainedPath& map) {
  const ContainedPath moved = Supersede(path, map);
  Warn(map.string() + ": what was kept or stood there is now " +
       moved.string());
}

// Nothing where there is no former map.
std::optional<MapState> InspectKept(const std::filesystem::path& root,
                                    const std::string& key,
                                    size_t kind,
                                    const Record& record) {
  const ContainedPath former = FormerPath(root, kind, key);
  return Exists(former)
             ? std::optional(InspectMap(
                   CurrentPath(root, kind, key), former, &record.written[kind]))
             : std::nullopt;
}

// Keeps what an import is about to replace, unless it is of imports itself.
// Throws kMismatch where nothing tells whose the maps are.
void KeepFormer(const std::filesystem::path& root,
                const std::string& key,
                const Record& record) {
  std::array<std::optional<MapState>, kFolders.size()> states;
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    states[kind] = InspectKept(root, key, kind, record);
  }
  const MapOwner owner = FindOwner(states[kDepth], states[kNormal]);
  const bool has_former = states[kDepth] || states[kNormal];
  if (has_former && owner == MapOwner::kUndecided) {
    throw Error::File(
        ErrorCode::kMismatch,
        CurrentPath(root, kDepth, key).string(),
        "nothing tells whether this map and its normals, or those "
        "that an import has kept, are the former ones",
        "decide by tsar_import " + OptionName("restore") + " 1 with " +
            OptionName("restore_conflicts") + " original or keep");
  }
  const bool is_replaced = has_former && owner == MapOwner::kOtherProgram;
  // All former ones go before the first of today is kept, so that at no instant
  // one of each is.
  for (size_t kind = 0; is_replaced && kind < kFolders.size(); ++kind) {
    if (states[kind]) {
      SupersedeAndWarn(FormerPath(root, kind, key),
                       CurrentPath(root, kind, key));
    }
  }
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    const ContainedPath current = CurrentPath(root, kind, key);
    if (!IsForeign(current, record.written[kind])) {
      continue;
    }
    if (states[kind] && !is_replaced) {
      if (states[kind] != MapState::kOriginal) {
        SupersedeAndWarn(current, current);  // An edited or damaged import.
      }
    } else {
      LinkOrCopyFile(current, FormerPath(root, kind, key));
    }
  }
}

// Undoes the import of one image's maps of one type.
class ImageUndoer {
 public:
  ImageUndoer(const std::filesystem::path& root,
              const std::string& key,
              RestoreConflicts conflicts,
              UndoResult* result)
      : root_(root), key_(key), conflicts_(conflicts), result_(result) {
    const std::optional<Record> record =
        ReadImportRecord(RecordPath(root, key));
    has_record_ = record.has_value();
    record_ = record.value_or(Record());
    for (size_t kind = 0; kind < kFolders.size(); ++kind) {
      states_[kind] =
          InspectMap(CurrentPath(root, kind, key),
                     FormerPath(root, kind, key),
                     has_record_ ? &record_.written[kind] : nullptr);
    }
  }

  void Run() {
    const std::filesystem::path depth = CurrentPath(root_, kDepth, key_);
    const MapOwner owner = FindOwner(states_[kDepth], states_[kNormal]);
    const bool puts_back = owner == MapOwner::kThisProgram || !has_record_ ||
                           record_.is_being_undone ||
                           conflicts_ == RestoreConflicts::kOriginal;
    if (puts_back) {
      const bool is_begun = !has_record_ || record_.is_being_undone;
      if (!is_begun) {
        record_.is_being_undone = true;
        WriteImportRecord(RecordPath(root_, key_), record_);
      }
      for (size_t kind = 0; kind < kFolders.size(); ++kind) {
        Undo(kind, is_begun);
      }
      RemoveEmptyFoldersUpTo(CurrentPath(root_, kCost, key_).Parent(),
                             ContainedPath(root_, "stereo"));
      ++result_->num_images;
      // Last: an interrupted undo still needs it.
      RemoveFile(RecordPath(root_, key_));
    } else if (owner == MapOwner::kOtherProgram ||
               conflicts_ == RestoreConflicts::kKeep) {
      result_->kept.push_back(depth);
    } else {
      result_->conflicts.push_back(depth);
    }
  }

 private:
  // is_begun: whether what has no former map is none of an import's.
  void Undo(size_t kind, bool is_begun) {
    const ContainedPath current = CurrentPath(root_, kind, key_);
    const ContainedPath former = FormerPath(root_, kind, key_);
    const MapState state = states_[kind];
    const bool has_former = Exists(former);
    if (state == MapState::kWritten && !has_former) {
      RemoveFile(current);
      return;
    }
    const bool is_foreign = state != MapState::kMissing &&
                            state != MapState::kWritten &&
                            state != MapState::kOriginal;
    // Costs that came since are none of an import's business.
    if (is_foreign && (has_former || (kind != kCost && !is_begun))) {
      result_->superseded.push_back(Supersede(current, current).Path());
    }
    if (!has_former) {
      return;
    }
    if (IsAnyOf(former, record_.written[kind])) {
      // An import wrote the same bytes. Were the next step the last one, the
      // map would then be taken for an imported one.
      record_.written[kind].clear();
      LinkOrCopyFile(former, current);
      WriteImportRecord(RecordPath(root_, key_), record_);
    }
    CreateFolders(current.Parent());
    RenameFile(former, current);
  }

  const std::filesystem::path& root_;
  const std::string& key_;
  const RestoreConflicts conflicts_;
  UndoResult* const result_;
  bool has_record_ = false;
  Record record_;
  std::array<MapState, kFolders.size()> states_ = {};
};

// Adds the keys of the files below a folder.
void AddKeys(const ContainedPath& folder,
             std::string_view suffix,
             std::set<std::string>* keys) {
  for (const TreeEntry& entry : ListTree(folder)) {
    const std::string name =
        entry.path.Path().lexically_relative(folder.Path()).string();
    if (!entry.is_folder && name.ends_with(suffix)) {
      keys->insert(name.substr(0, name.size() - suffix.size()));
    }
  }
}

}  // namespace

ContainedPath GetImportFolder(const std::filesystem::path& root) {
  return {root, std::filesystem::path("stereo") / "tsar_import"};
}

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
  const std::string key = KeyOf(image_name, type);
  const Record record =
      ReadImportRecord(RecordPath(root, key)).value_or(Record());
  for (const size_t kind : {kDepth, kNormal}) {
    const ContainedPath path = CurrentPath(root, kind, key);
    if (IsForeign(path, record.written[kind])) {
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

void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps) {
  const std::string key = KeyOf(image_name, type);
  const Record earlier =
      ReadImportRecord(RecordPath(root, key)).value_or(Record());
  Record record = earlier;
  record.is_being_undone = false;
  std::vector<AtomicFile> files;
  const bool has_cost = !maps.cost.values.empty();
  for (size_t kind = 0; kind < (has_cost ? 3u : 2u); ++kind) {
    const ContainedPath path = CurrentPath(root, kind, key);
    CreateFolders(path.Parent());
    AtomicFile& file = files.emplace_back(path);
    WrittenMap written = kind == kDepth    ? PutDepthMap(maps.depth, &file)
                         : kind == kNormal ? PutNormalMap(maps.normal, &file)
                                           : PutPlanarMap(maps.cost, &file);
    file.Prepare();
    written.time = file.Time();
    std::vector<WrittenMap>& known = record.written[kind];
    if (std::ranges::find(known, written.hash, &WrittenMap::hash) ==
        known.end()) {
      known.push_back(std::move(written));
    }
  }
  KeepFormer(root, key, earlier);
  WriteImportRecord(RecordPath(root, key), record);
  for (AtomicFile& file : files) {
    file.Commit();
  }
  if (!has_cost) {
    // It says how well other depths explain the photos.
    RemoveFile(CurrentPath(root, kCost, key));
  }
}

UndoResult UndoImport(const std::filesystem::path& root,
                      RestoreConflicts conflicts) {
  RequireUnrefined(root);
  std::set<std::string> keys;
  AddKeys(RecordFolder(root), ".json", &keys);
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    // An import that was killed may have no record yet.
    AddKeys(FormerFolder(root, kind), ".bin", &keys);
  }
  if (keys.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      GetImportFolder(root).string(),
                      "nothing was imported into this workspace",
                      "check " + OptionName("workspace_path"));
  }
  UndoResult result;
  // All is looked at before the first file is changed.
  std::vector<ImageUndoer> images;
  for (const std::string& key : keys) {
    images.emplace_back(root, key, conflicts, &result);
  }
  for (ImageUndoer& image : images) {
    image.Run();
  }
  // Also those of images that have no record yet.
  for (const char* folder : kFolders) {
    RemoveTemporaries({root, std::filesystem::path("stereo") / folder});
  }
  RemoveTemporaries(GetImportFolder(root));
  RemoveEmptyFolders(GetImportFolder(root));
  return result;
}

}  // namespace tsar
