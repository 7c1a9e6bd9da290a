// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/view/refined_maps.h"

#include <array>
#include <filesystem>
#include <string>

namespace tsar {

// What the page shows about one refined image, besides its pictures.
struct ImagePage {
  std::string name;
  std::string folder;  // Folder of its pictures, below that of all images.
  int width = 0;       // Size of the maps.
  int height = 0;
  int picture_width = 0;  // Size of the pictures.
  int picture_height = 0;
  DepthRange range;           // For the colors of depth.
  double share_before = 0.0;  // Share of the pixels that have a depth.
  double share_after = 0.0;
  bool has_confidence = false;  // Whether there is a picture of this map.
  bool has_planes = false;
  // Shares of the pixels, by the value of the provenance map.
  std::array<double, kProvenanceNames.size()> shares_by_provenance = {};
  double seconds = 0.0;  // Of one worker; 0: not recorded.
  std::string note;      // Note of its record.
};

// Writes the pictures of a refined image to a new folder in `folder`, named by
// its index on the page. max_picture_size: their longer side, in pixels. Throws
// Error: what ReadImageMaps, ReadOriginalImageMaps and Workspace::ReadImage
// throw, kCorrupt (an unknown value of provenance), kIo.
ImagePage WriteImagePage(const Workspace& workspace,
                         int image,
                         int number,
                         const std::filesystem::path& folder,
                         int max_picture_size);

}  // namespace tsar
