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
#include <utility>
#include <vector>

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
std::optional<MapState> InspectKept(const std::filesystem::path& root,
                                    const std::string& key,
                                    size_t kind,
                                    const ImportRecord& record) {
  const ContainedPath former = GetFormerPath(root, kind, key);
  return Exists(former)
             ? std::optional(InspectMap(
                   GetMapPath(root, kind, key), former, &record.written[kind]))
             : std::nullopt;
}

// Keeps the maps that an import is about to replace, unless imports wrote them,
// and describes those in the record. Throws kMismatch if their source is
// unknown.
void KeepFormer(const std::filesystem::path& root,
                const std::string& key,
                const ImportRecord& record,
                ImportRecord* next) {
  std::array<std::optional<MapState>, kImportFolders.size()> states;
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    states[kind] = InspectKept(root, key, kind, record);
  }
  const MapOwner owner = FindOwner(states[kDepthMaps], states[kNormalMaps]);
  const bool has_former = states[kDepthMaps] || states[kNormalMaps];
  if (has_former && owner == MapOwner::kUndecided) {
    throw Error::File(
        ErrorCode::kMismatch,
        GetMapPath(root, kDepthMaps, key).string(),
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
      SupersedeAndWarn(GetFormerPath(root, kind, key),
                       GetMapPath(root, kind, key));
    }
  }
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    const ContainedPath current = GetMapPath(root, kind, key);
    const ContainedPath former = GetFormerPath(root, kind, key);
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
  const std::string key = GetImportKey(image_name, type);
  const ImportRecord record =
      ReadImportRecord(GetImportRecordPath(root, key)).value_or(ImportRecord());
  for (const size_t kind : {kDepthMaps, kNormalMaps}) {
    const ContainedPath path = GetMapPath(root, kind, key);
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
  const std::string key = GetImportKey(image_name, type);
  for (size_t kind = 0; kind < kImportFolders.size(); ++kind) {
    RequireNoFolder(GetMapPath(root, kind, key).Path());
    RequireNoFolder(GetFormerPath(root, kind, key).Path());
  }
  RequireNoFolder(GetImportRecordPath(root, key).Path());
}

void WriteImported(const std::filesystem::path& root,
                   const std::string& image_name,
                   MapType type,
                   const ImportedMaps& maps) {
  const std::string key = GetImportKey(image_name, type);
  const ImportRecord earlier =
      ReadImportRecord(GetImportRecordPath(root, key)).value_or(ImportRecord());
  ImportRecord record = earlier;
  record.is_being_undone = false;
  std::vector<AtomicFile> files;
  const bool has_cost = !maps.cost.values.empty();
  for (size_t kind = 0; kind < (has_cost ? 3u : 2u); ++kind) {
    const ContainedPath path = GetMapPath(root, kind, key);
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
  KeepFormer(root, key, earlier, &record);
  WriteImportRecord(GetImportRecordPath(root, key), record);
  for (AtomicFile& file : files) {
    file.Commit();
  }
  if (!has_cost) {
    // The cost map belongs to other depths.
    RemoveFile(GetMapPath(root, kCostMaps, key));
  }
}

}  // namespace tsar
