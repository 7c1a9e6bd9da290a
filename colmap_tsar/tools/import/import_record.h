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

// The record of imports of one image's maps of one type, stored as
// stereo/tsar_import/records/KEY.json.
struct ImportRecord {
  // The maps that imports may have written, for each of kImportFolders.
  std::array<std::vector<WrittenMap>, kImportFolders.size()> written;
  // The former maps that are kept for them, by their content alone; nothing
  // where none is kept.
  std::array<std::optional<WrittenMap>, kImportFolders.size()> former;
  // Whether their undo has begun: a map without a former one may have been
  // restored already.
  bool is_being_undone = false;
};

// The folder stereo/tsar_import with the maps that imports replaced and records
// of those they wrote. It is separate from stereo/tsar, since tsar_refine
// treats imported maps as originals.
ContainedPath GetImportFolder(const std::filesystem::path& root);

// The image's name and the type, which name maps and records.
std::string GetImportKey(const std::string& image_name, MapType type);

// The path of a map of one of kImportFolders, and that of the former map that
// an import replaced.
ContainedPath GetMapPath(const std::filesystem::path& root,
                         size_t kind,
                         const std::string& key);
ContainedPath GetFormerFolder(const std::filesystem::path& root, size_t kind);
ContainedPath GetFormerPath(const std::filesystem::path& root,
                            size_t kind,
                            const std::string& key);
ContainedPath GetImportRecordFolder(const std::filesystem::path& root);
ContainedPath GetImportRecordPath(const std::filesystem::path& root,
                                  const std::string& key);

// Returns nullopt if there is no record. Throws Error kCorrupt if it is
// invalid.
std::optional<ImportRecord> ReadImportRecord(const std::filesystem::path& path);

// Writes a record atomically and creates the folder. Throws Error kIo.
void WriteImportRecord(const ContainedPath& path, const ImportRecord& record);

}  // namespace tsar
