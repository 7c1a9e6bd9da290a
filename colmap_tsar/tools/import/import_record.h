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

// The three kinds of maps that an import writes, by the names of their folders.
inline constexpr std::array<const char*, 3> kImportFolders = {
    "depth_maps", "normal_maps", "cost_maps"};
inline constexpr size_t kDepthMaps = 0;
inline constexpr size_t kNormalMaps = 1;
inline constexpr size_t kCostMaps = 2;

// What is known of the imports of one image's maps of one type, kept as
// stereo/tsar_import/records/KEY.json.
struct ImportRecord {
  // The maps that they may have left under a name, for each of kImportFolders.
  std::array<std::vector<WrittenMap>, kImportFolders.size()> written;
  // Whether undoing them has begun: what has no former map then may have been
  // put back.
  bool is_being_undone = false;
};

// stereo/tsar_import: the maps that imports have replaced, and a record of what
// they wrote. Apart from stereo/tsar, since to tsar_refine imported maps are
// originals as good as COLMAP's.
ContainedPath GetImportFolder(const std::filesystem::path& root);

// The image's name and the type, by which maps and records are named.
std::string GetImportKey(const std::string& image_name, MapType type);

// Where a map of one of kImportFolders lies, and where the one that an import
// has replaced is kept.
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

// Nothing where there is no record; Error kCorrupt where the file is none.
std::optional<ImportRecord> ReadImportRecord(const std::filesystem::path& path);

// In one step; creates the folder. Error kIo.
void WriteImportRecord(const ContainedPath& path, const ImportRecord& record);

}  // namespace tsar
