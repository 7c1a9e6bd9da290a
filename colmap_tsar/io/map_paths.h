// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>

namespace tsar {

// A set of maps, by the suffix in the names of its files, such as geometric in
// stereo/depth_maps/a.jpg.geometric.bin.
class MapType {
 public:
  // Those that COLMAP's patch_match_stereo writes.
  static const MapType kPhotometric;
  static const MapType kGeometric;

  // The type of a suffix that other programs or versions may write. Throws
  // Error kBadOption, naming input_type, for what is not one word of letters,
  // digits and underscores.
  static MapType Parse(const std::string& suffix);

  bool operator==(const MapType& other) const = default;
  friend std::string ToString(MapType type);

 private:
  explicit constexpr MapType(std::string_view suffix) {
    std::ranges::copy(suffix, suffix_.begin());
  }

  std::array<char, 32> suffix_{};  // Ends in a zero.
};
inline constexpr MapType MapType::kPhotometric("photometric");
inline constexpr MapType MapType::kGeometric("geometric");

// The suffix.
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
