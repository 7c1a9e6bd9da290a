// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_paths.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"

#include <set>

namespace tsar {
namespace {

bool IsSuffix(std::string_view word) {
  return !word.empty() && word.size() < 32 &&
         word.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyz"
             "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") == std::string_view::npos;
}

}  // namespace

MapType MapType::Parse(const std::string& suffix) {
  if (!IsSuffix(suffix)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("input_type") + ": '" + suffix +
                    "' is no type of maps; give geometric, photometric, or "
                    "the word before .bin in the names of the maps");
  }
  return MapType(suffix);
}

std::string ToString(MapType type) { return type.suffix_.data(); }

std::string AdviceOfTypes(const std::filesystem::path& root) {
  std::set<std::string> types;
  for (const std::string& name :
       ListFileNames({root / "stereo" / "depth_maps", {}}, ".bin")) {
    const std::string type = name.substr(name.rfind('.') + 1);
    if (type.size() < name.size() && IsSuffix(type)) {
      types.insert(type);
    }
  }
  std::string advice;
  for (const std::string& type : types) {
    advice += (advice.empty() ? " (there are: " : ", ") + type;
  }
  return "choose another " + OptionName("input_type") + advice +
         (advice.empty() ? "" : ")");
}

MapPaths GetMapPaths(const std::filesystem::path& root,
                     const std::string& key) {
  const ContainedPath stereo(root, "stereo");
  const ContainedPath original = GetTsarFolder(root) / "original";
  MapPaths paths;
  paths.depth = stereo / "depth_maps" / (key + ".bin");
  paths.normal = stereo / "normal_maps" / (key + ".bin");
  paths.cost = stereo / "cost_maps" / (key + ".bin");
  paths.confidence = stereo / "confidence_maps" / (key + ".png");
  paths.sigma = stereo / "sigma_maps" / (key + ".npy");
  paths.provenance = stereo / "provenance_maps" / (key + ".png");
  paths.planes = stereo / "plane_maps" / (key + ".png");
  paths.original_depth = original / "depth_maps" / (key + ".bin");
  paths.original_normal = original / "normal_maps" / (key + ".bin");
  paths.record = GetTsarFolder(root) / "records" / (key + ".json");
  return paths;
}

MapPaths GetMapPaths(const std::filesystem::path& root,
                     const std::string& image_name,
                     MapType type) {
  return GetMapPaths(root, image_name + "." + ToString(type));
}

ContainedPath GetTsarFolder(const std::filesystem::path& root) {
  return {root, std::filesystem::path("stereo") / "tsar"};
}

ContainedPath GetSupersededFolder(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "superseded";
}

}  // namespace tsar
