// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/import_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/content_hash.h"
#include "colmap_tsar/workspace/output_workspace.h"
#include "colmap_tsar/workspace/workspace_lock.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <optional>
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

// The fingerprints of all files that imports may have left under a map's name,
// for each of kFolders.
using Record = std::array<std::vector<uint64_t>, kFolders.size()>;

std::string KeyOf(const std::string& image_name, MapType type) {
  return image_name + "." + ToString(type);
}

std::filesystem::path CurrentPath(const std::filesystem::path& root,
                                  size_t kind,
                                  const std::string& key) {
  return root / "stereo" / kFolders[kind] / (key + ".bin");
}

std::filesystem::path FormerPath(const std::filesystem::path& root,
                                 size_t kind,
                                 const std::string& key) {
  return GetImportFolder(root) / "former" / kFolders[kind] / (key + ".bin");
}

std::filesystem::path RecordFolder(const std::filesystem::path& root) {
  return GetImportFolder(root) / "records";
}

std::filesystem::path RecordPath(const std::filesystem::path& root,
                                 const std::string& key) {
  return RecordFolder(root) / (key + ".json");
}

bool Exists(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::exists(path, error);
}

// Empty lists where there is no record.
Record ReadImportRecord(const std::filesystem::path& path) {
  Record record;
  if (!Exists(path)) {
    return record;
  }
  std::ifstream file(path);
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    for (size_t kind = 0; kind < kFolders.size(); ++kind) {
      record[kind] = json.at(kFolders[kind]).get<std::vector<uint64_t>>();
    }
  } catch (const nlohmann::json::exception&) {
    throw Error::File(
        ErrorCode::kCorrupt,
        path.string(),
        "not a record of this program",
        "look at the maps in stereo/tsar_import/former, move them "
        "back by hand and delete stereo/tsar_import");
  }
  return record;
}

void WriteImportRecord(const std::filesystem::path& path,
                       const Record& record) {
  nlohmann::json json;
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    json[kFolders[kind]] = record[kind];
  }
  CreateFolders(path.parent_path());
  AtomicFile file(path);
  file.Stream() << json.dump(2) << "\n";
  file.Commit();
}

bool Contains(const std::vector<uint64_t>& hashes, uint64_t hash) {
  return std::find(hashes.begin(), hashes.end(), hash) != hashes.end();
}

// Whether a file is there that no import has written.
bool IsForeign(const std::filesystem::path& path,
               const std::vector<uint64_t>& ours) {
  return Exists(path) && (ours.empty() || !Contains(ours, HashFile(path)));
}

// Removes folders that hold nothing, from `folder` up to below `top`.
void RemoveEmptyFolders(std::filesystem::path folder,
                        const std::filesystem::path& top) {
  std::error_code error;
  while (folder != top && std::filesystem::remove(folder, error)) {
    folder = folder.parent_path();
  }
}

void UndoImage(const std::filesystem::path& root,
               const std::string& key,
               UndoResult* result) {
  Record record = ReadImportRecord(RecordPath(root, key));
  bool is_newer = false;
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    const std::filesystem::path current = CurrentPath(root, kind, key);
    const std::filesystem::path former = FormerPath(root, kind, key);
    // A former map of the same bytes is the link that an interrupted import
    // made before it changed anything.
    const bool is_unchanged = Exists(current) && Exists(former) &&
                              HashFile(current) == HashFile(former);
    if (IsForeign(current, record[kind]) && !is_unchanged) {
      is_newer = true;
      RemoveFile(former);
    } else if (Exists(former)) {
      if (Contains(record[kind], HashFile(former))) {
        // An import wrote the same bytes. Were the next step the last one, the
        // map would then be taken for an imported one.
        record[kind].clear();
        LinkOrCopyFile(former, current);
        WriteImportRecord(RecordPath(root, key), record);
      }
      CreateFolders(current.parent_path());
      RenameFile(former, current);
    } else if (Exists(current)) {
      RemoveFile(current);
    }
  }
  RemoveEmptyFolders(CurrentPath(root, kCost, key).parent_path(),
                     root / "stereo");
  ++result->num_images;
  result->num_newer += is_newer ? 1 : 0;
  // Last: an interrupted undo still needs it.
  RemoveFile(RecordPath(root, key));
}

}  // namespace

std::filesystem::path GetImportFolder(const std::filesystem::path& root) {
  return root / "stereo" / "tsar_import";
}

void RequireUnrefined(const std::filesystem::path& root) {
  if (const auto source = ReadOutputMarker(root)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        root.string(),
        "tsar_refine made this workspace from " + source->string(),
        "import into that one");
  }
  std::error_code error;
  for (const auto& entry :
       std::filesystem::directory_iterator(GetTsarFolder(root), error)) {
    if (entry.path().filename() != WorkspaceLock::kFileName) {
      throw Error::File(ErrorCode::kUnsupported,
                        GetTsarFolder(root).string(),
                        "tsar_refine has worked on this workspace",
                        "undo that first with tsar_refine --restore 1");
    }
  }
}

void RequireNoForeignMaps(const std::filesystem::path& root,
                          const std::string& image_name,
                          MapType type) {
  const std::string key = KeyOf(image_name, type);
  const Record record = ReadImportRecord(RecordPath(root, key));
  for (const size_t kind : {kDepth, kNormal}) {
    const std::filesystem::path path = CurrentPath(root, kind, key);
    if (IsForeign(path, record[kind])) {
      throw Error::File(ErrorCode::kUnsupported,
                        path.string(),
                        "the image has a map of this type already",
                        "give --overwrite 1 to replace such maps (tsar_import "
                        "--restore 1 puts them back), or another "
                        "--output_type");
    }
  }
}

void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps) {
  const std::string key = KeyOf(image_name, type);
  const Record earlier = ReadImportRecord(RecordPath(root, key));
  Record record = earlier;
  std::vector<AtomicFile> files;
  const bool has_cost = !maps.cost.values.empty();
  for (size_t kind = 0; kind < (has_cost ? 3u : 2u); ++kind) {
    const std::filesystem::path path = CurrentPath(root, kind, key);
    CreateFolders(path.parent_path());
    AtomicFile& file = files.emplace_back(path);
    const uint64_t hash = kind == kDepth    ? PutDepthMap(maps.depth, &file)
                          : kind == kNormal ? PutNormalMap(maps.normal, &file)
                                            : PutPlanarMap(maps.cost, &file);
    file.Prepare();
    if (!Contains(record[kind], hash)) {
      record[kind].push_back(hash);
    }
  }
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    const std::filesystem::path current = CurrentPath(root, kind, key);
    if (IsForeign(current, earlier[kind])) {
      LinkOrCopyFile(current, FormerPath(root, kind, key));
    }
  }
  WriteImportRecord(RecordPath(root, key), record);
  for (AtomicFile& file : files) {
    file.Commit();
  }
  if (!has_cost) {
    // It says how well other depths explain the photos.
    RemoveFile(CurrentPath(root, kCost, key));
  }
}

UndoResult UndoImport(const std::filesystem::path& root) {
  RequireUnrefined(root);
  const std::filesystem::path records = RecordFolder(root);
  constexpr std::string_view kSuffix = ".json";
  std::vector<std::string> keys;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(records, error), end;
       !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().lexically_relative(records).string();
    if (!it->is_directory() && name.ends_with(kSuffix)) {
      keys.push_back(name.substr(0, name.size() - kSuffix.size()));
    }
  }
  if (keys.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      GetImportFolder(root).string(),
                      "nothing was imported into this workspace",
                      "check --workspace_path");
  }
  UndoResult result;
  for (const std::string& key : keys) {
    UndoImage(root, key, &result);
  }
  // Also those of images that have no record yet.
  for (const char* folder : kFolders) {
    RemoveTemporaries(root / "stereo" / folder);
  }
  std::filesystem::remove_all(GetImportFolder(root), error);
  return result;
}

}  // namespace tsar
