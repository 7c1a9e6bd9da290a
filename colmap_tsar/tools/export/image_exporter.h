// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/export/map_levels.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {

// The description of one exported image.
struct ExportedImage {
  int width = 0;  // Size of its maps.
  int height = 0;
  DepthStatistics depth;  // As in the workspace.
  // The number of depths that the format cannot represent.
  int64_t num_out_of_range = 0;
  // The path in the export by kind of map or "photo".
  std::map<std::string, std::string> files;
};

// Writes one format into a folder.
class ImageExporter {
 public:
  virtual ~ImageExporter() = default;

  // Describes the files of each kind of map, for the manifest.
  virtual nlohmann::ordered_json DescribeMaps() const = 0;

  // Writes the files of one image of the sparse model; thread-safe.
  virtual ExportedImage Export(int image) const = 0;

  // Writes the files of the full export after all images, and warns users.
  // images and exported: the arguments and results of Export().
  virtual void Finish(const std::vector<int>& images,
                      const std::vector<ExportedImage>& exported) const = 0;
};

// "17.3 % of the depths", for messages.
std::string ShareOfDepths(int64_t count, int64_t num_depths);

}  // namespace tsar
