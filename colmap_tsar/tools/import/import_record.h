// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/written_map.h"

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The folders of the three kinds of maps that an import writes.
inline constexpr std::array<const char*, 3> kImportFolders = {
    "depth_maps", "normal_maps", "cost_maps"};
inline constexpr size_t kDepthMaps = 0;
inline constexpr size_t kNormalMaps = 1;
inline constexpr size_t kCostMaps = 2;

// The imports of one image's maps of one type, in tsar_import/records/KEY.json.
struct ImportRecord {
  // The maps that imports may have written, for each of kImportFolders.
  std::array<std::vector<WrittenMap>, kImportFolders.size()> written;
  // The former maps that are kept for them, by their content alone, if any.
  std::array<std::optional<WrittenMap>, kImportFolders.size()> former;
  // Whether undo has begun: a map without a former one may be restored already.
  bool is_being_undone = false;
};

// stereo/tsar_import: the maps that imports replaced and records of those they
// wrote. tsar_refine, with stereo/tsar, treats imported maps as originals.
ContainedPath GetImportFolder(const std::filesystem::path& root);

// The folders of former maps of a kind, and of records.
ContainedPath GetFormerFolder(const std::filesystem::path& root, size_t kind);
ContainedPath GetImportRecordFolder(const std::filesystem::path& root);

// The files of one image's maps of one type and of what imports keep for them.
struct ImportPaths {
  std::array<ContainedPath, kImportFolders.size()> maps;
  std::array<ContainedPath, kImportFolders.size()> former;
  ContainedPath record;
};
// key: the image's name and the type, by which maps and records are named.
ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& key);
ImportPaths GetImportPaths(const std::filesystem::path& root,
                           const std::string& image_name,
                           MapType type);

// Returns nullopt without a record. Throws Error kCorrupt for an invalid one.
std::optional<ImportRecord> ReadImportRecord(const std::filesystem::path& path);

// Writes a record atomically and creates its folder. Throws Error kIo.
void WriteImportRecord(const ContainedPath& path, const ImportRecord& record);

}  // namespace tsar
