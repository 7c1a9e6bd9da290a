// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/export/image_maps.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {

// What was written of one image.
struct ExportedImage {
  int width = 0;  // Of its maps.
  int height = 0;
  DepthStatistics depth;  // As in the workspace.
  // Depths that the format cannot hold as they are.
  int64_t num_out_of_range = 0;
  // By kind of map, or "photo": the path in the export.
  std::map<std::string, std::string> files;
};

// Writes one format into a folder.
class ImageExporter {
 public:
  virtual ~ImageExporter() = default;

  // Of each kind of map, what its files hold: goes into the manifest.
  virtual nlohmann::ordered_json DescribeMaps() const = 0;

  // Writes the files of one image of the sparse model; from several threads.
  virtual ExportedImage Export(int image) const = 0;

  // Writes the files of the whole once all images are there, and warns of what
  // users should know. images: what Export() was called with, and returned.
  virtual void Finish(const std::vector<int>& images,
                      const std::vector<ExportedImage>& exported) const = 0;
};

// "17.3 % of the depths", for messages.
std::string ShareOfDepths(int64_t count, int64_t num_depths);

}  // namespace tsar
