// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <array>
#include <filesystem>
#include <string>

namespace tsar {

// The two sets of maps that COLMAP's patch_match_stereo writes.
enum class MapType { kPhotometric, kGeometric };
inline constexpr std::array kMapTypes = {MapType::kPhotometric,
                                         MapType::kGeometric};

// As in the names of its files, stereo/depth_maps/a.jpg.geometric.bin.
std::string ToString(MapType type);

// Advice where maps of a type are missing: the option input_type with the types
// of which the workspace has depth maps.
std::string AdviceOfTypes(const std::filesystem::path& root);

// The paths of one image's maps of one type.
struct MapPaths {
  ContainedPath depth;
  ContainedPath normal;
  ContainedPath cost;
  ContainedPath confidence;
  ContainedPath sigma;
  ContainedPath provenance;
  ContainedPath planes;  // The scene plane of each pixel.
  ContainedPath original_depth;
  ContainedPath original_normal;
  ContainedPath record;
};

// key: image name with type, e.g. "left/0001.jpg.geometric".
MapPaths GetMapPaths(const std::filesystem::path& root, const std::string& key);
MapPaths GetMapPaths(const std::filesystem::path& root,
                     const std::string& image_name,
                     MapType type);

// stereo/tsar: the folder that belongs to this program alone.
ContainedPath GetTsarFolder(const std::filesystem::path& root);

// Files replaced when an original was restored, and originals replaced by newer
// ones; the subfolders are those of stereo. Never removed by this program.
ContainedPath GetSupersededFolder(const std::filesystem::path& root);

}  // namespace tsar
