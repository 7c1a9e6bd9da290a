// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_store.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/record.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The folders of the maps that an import writes, and their names in records.
constexpr std::array<const char*, 3> kFolders = {
    "depth_maps", "normal_maps", "cost_maps"};
constexpr size_t kDepthMaps = 0;
constexpr size_t kNormalMaps = 1;
constexpr size_t kCostMaps = 2;

// stereo/tsar_import: the maps that imports replaced and records of those they
// wrote. tsar_refine, with stereo/tsar, treats imported maps as originals.
ContainedPath GetImportFolder(const std::filesystem::path& root) {
  return {root, std::filesystem::path("stereo") / "tsar_import"};
}

// The files of one image's maps of one type and of what imports keep for them.
struct ImportPaths {
  std::array<ContainedPath, kFolders.size()> maps;
  std::array<ContainedPath, kFolders.size()> former;
  ContainedPath record;
};

// key: the image's name and the type, by which maps and records are named.
ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& key) {
  ImportPaths paths;
  const ContainedPath stereo(root, "stereo");
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    paths.maps[kind] = stereo / kFolders[kind] / (key + ".bin");
    paths.former[kind] =
        GetImportFolder(root) / "former" / kFolders[kind] / (key + ".bin");
  }
  paths.record = GetImportFolder(root) / "records" / (key + ".json");
  return paths;
}

ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& image_name,
                           MapType type) {
  return GetImportPaths(root, image_name + "." + ToString(type));
}

// The former maps; `path` is of no use where an import wrote the first map.
std::array<OriginalMap, kFolders.size()> InspectFormer(
    const ImportPaths& paths, const std::optional<ImageRecord>& record) {
  std::array<OriginalMap, kFolders.size()> former;
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    former[kind] = InspectOriginal(
        paths.maps[kind], paths.former[kind], record, kFolders[kind]);
  }
  return former;
}

// Keeps a map that an import will replace, unless an import wrote it.
void KeepFormer(const OriginalMap& former,
                const ContainedPath& current,
                const ContainedPath& kept) {
  if (former.state == MapState::kUnknown) {
    Supersede(current, current);
  } else if (former.state == MapState::kForeign ||
             former.state == MapState::kDamaged) {
    KeepOriginal(former, current, kept);
  }
}

// Whether an import was killed in a write: it leaves its temporary.
bool HasTemporaries(const std::filesystem::path& root) {
  return std::ranges::any_of(kFolders, [&](const char* folder) {
    return !ListFileNames({root, std::filesystem::path("stereo") / folder},
                          AtomicFile::kTemporarySuffix)
                .empty();
  });
}

// The import of one image's maps of one type.
struct Import {
  ImportPaths paths;
  std::optional<ImageRecord> record;
  std::array<OriginalMap, kFolders.size()> former;
};

void Undo(const Import& import, RestoreResult* result) {
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    const OriginalMap& former = import.former[kind];
    const ContainedPath& current = import.paths.maps[kind];
    if (former.is_kept && former.state == MapState::kForeign) {
      result->kept.push_back(current);
    }
    if (const auto superseded =
            PutOriginalBack(former, current, import.paths.former[kind])) {
      result->superseded.push_back(*superseded);
    } else if (!former.is_kept && former.state == MapState::kRefined) {
      RemoveFile(current);
    } else if (!former.is_kept && former.state == MapState::kDamaged &&
               import.record && import.record->files.contains(kFolders[kind])) {
      result->superseded.push_back(Supersede(current, current));
    }
  }
  ++result->num_restored;
  // An interrupted undo still needs the record.
  RemoveFile(import.paths.record);
}

}  // namespace

void RequireUnrefined(const std::filesystem::path& root) {
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
  const auto former = InspectFormer(paths, ReadRecord(paths.record));
  for (const size_t kind : {kDepthMaps, kNormalMaps}) {
    if (former[kind].state != MapState::kMissing &&
        former[kind].state != MapState::kRefined) {
      throw Error::File(
          ErrorCode::kUnsupported,
          paths.maps[kind].string(),
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
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
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
  const auto former = InspectFormer(paths, ReadRecord(paths.record));
  ImageRecord record;
  record.image = image_name;
  record.type = ToString(type);
  record.status = ImageStatus::kDone;
  std::vector<AtomicFile> files;
  const bool has_cost = !maps.cost.values.empty();
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    const ContainedPath& path = paths.maps[kind];
    std::vector<FileId>& ids = record.files[kFolders[kind]];
    if (kind != kCostMaps || has_cost) {
      CreateFolders(path.Parent());
      AtomicFile& file = files.emplace_back(path);
      const uint64_t hash = kind == kDepthMaps ? PutDepthMap(maps.depth, &file)
                            : kind == kNormalMaps
                                ? PutNormalMap(maps.normal, &file)
                                : PutPlanarMap(maps.cost, &file);
      ids.push_back(IdOfPrepared(path, &file, hash));
    }
    if (former[kind].state == MapState::kRefined) {
      ids.push_back(FindFileId(path).value_or(FileId()));
    }
    if (ids.empty()) {
      record.files.erase(kFolders[kind]);
    }
  }
  WriteRecord(paths.record, record);
  for (size_t kind = 0; kind < kFolders.size(); ++kind) {
    KeepFormer(former[kind], paths.maps[kind], paths.former[kind]);
  }
  for (AtomicFile& file : files) {
    file.Commit();
  }
  if (!has_cost) {
    // The cost map belongs to other depths.
    RemoveFile(paths.maps[kCostMaps]);
  }
}

RestoreResult UndoImport(const std::filesystem::path& root) {
  RequireUnrefined(root);
  const ContainedPath folder = GetImportFolder(root);
  std::set<std::string> keys;
  keys.merge(ListFileNames(folder / "records", ".json"));
  for (const char* kind : kFolders) {
    keys.merge(ListFileNames(folder / "former" / kind, ".bin"));
  }
  if (keys.empty() && !HasTemporaries(root)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "nothing was imported into this workspace",
                      "check " + OptionName("workspace_path"));
  }
  // Everything is checked before the first file is changed.
  std::vector<Import> imports;
  for (const std::string& key : keys) {
    Import import = {GetImportPaths(root, key), std::nullopt, {}};
    for (const ContainedPath& former : import.paths.former) {
      RequireFileIfThere(former);
    }
    import.record = ReadRecordIfValid(import.paths.record);
    import.former = InspectFormer(import.paths, import.record);
    imports.push_back(std::move(import));
  }
  RestoreResult result;
  for (const Import& import : imports) {
    Undo(import, &result);
  }
  // This includes the temporaries of images without a record.
  for (const char* kind : kFolders) {
    RemoveTemporaries({root, std::filesystem::path("stereo") / kind});
  }
  RemoveEmptyFolders(GetMapPaths(root, "").cost.Parent());
  RemoveTemporaries(folder);
  RemoveEmptyFolders(folder);
  return result;
}

}  // namespace tsar
