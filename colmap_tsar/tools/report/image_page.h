// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/point_sample.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The content of the page for one refined image.
struct ImagePage {
  std::string name;
  std::string folder;  // Folder of its pictures, below that of all images.
  int width = 0;       // Size of the maps.
  int height = 0;
  int picture_width = 0;  // Size of the pictures.
  int picture_height = 0;
  DepthRange range;        // For the colors of depth.
  int64_t num_before = 0;  // Pixels with a depth.
  int64_t num_after = 0;
  std::vector<int64_t> num_by_provenance;  // Like ProvenanceKinds().
  std::map<std::string, double> seconds;   // Per stage, if recorded.
  std::string note;                        // Note of its record.
  bool has_sigma = false;   // Whether there is a picture of its sigma map.
  bool has_planes = false;  // Whether there is a picture of its planes.
  bool has_prior = false;   // Whether there is a picture of its depth prior.
  PointSample points_before;
  PointSample points_after;
};

struct ImagePageOptions {
  int max_picture_size = 1000;  // Longer side, in pixels.
  bool show_planes = false;  // For images with a plane map.
  // The points of the 3D view; 0 points for none.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  int64_t max_num_points = 0;
};

// Writes the pictures of a refined image to a new folder in `folder`, named by
// its index on the page. Throws Error: those of ReadComparisonRow, kCorrupt and
// kMismatch for an invalid confidence, sigma or plane map, kIo.
ImagePage WriteImagePage(const Workspace& workspace,
                         int image,
                         int number,
                         const std::filesystem::path& folder,
                         const ImagePageOptions& options);

}  // namespace tsar
