// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// The two sets of maps that COLMAP's patch_match_stereo writes.
enum class MapType { kPhotometric, kGeometric };

// "photometric" or "geometric", as in the names of the files.
std::string ToString(MapType type);

// Where everything about one image's maps of one type lies.
struct MapPaths {
  std::filesystem::path depth;
  std::filesystem::path normal;
  std::filesystem::path cost;
  std::filesystem::path confidence;
  std::filesystem::path provenance;
  std::filesystem::path original_depth;
  std::filesystem::path original_normal;
  std::filesystem::path record;
};

// key: image name with type, e.g. "left/0001.jpg.geometric".
MapPaths GetMapPaths(const std::filesystem::path& root, const std::string& key);
MapPaths GetMapPaths(const std::filesystem::path& root,
                     const std::string& image_name,
                     MapType type);

// stereo/tsar: the folder that belongs to this program alone.
std::filesystem::path GetTsarFolder(const std::filesystem::path& root);

}  // namespace tsar
