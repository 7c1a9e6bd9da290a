// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_paths.h"

#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <set>

namespace tsar {

std::string ToString(MapType type) {
  return type == MapType::kGeometric ? "geometric" : "photometric";
}

std::string AdviceOfTypes(const std::filesystem::path& root) {
  const std::set<std::string> names =
      ListFileNames({root / "stereo" / "depth_maps", {}}, ".bin");
  std::string advice;
  for (const std::string type : {"geometric", "photometric"}) {
    if (std::ranges::any_of(names, [&](const std::string& name) {
          return name.ends_with("." + type);
        })) {
      advice += (advice.empty() ? " (there are: " : ", ") + type;
    }
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
