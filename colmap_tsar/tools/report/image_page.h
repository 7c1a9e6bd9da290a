// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/report/colors.h"
#include "colmap_tsar/tools/report/point_sample.h"
#include "colmap_tsar/view/refine_observer.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// What the page shows of one refined image.
struct ImagePage {
  std::string name;
  std::string folder;  // Of its pictures, below that of all images.
  int width = 0;       // Of the maps.
  int height = 0;
  int picture_width = 0;  // Of the pictures.
  int picture_height = 0;
  DepthRange range;        // Of the colors of depth.
  int64_t num_before = 0;  // Pixels with a depth.
  int64_t num_after = 0;
  std::vector<int64_t> num_by_provenance;  // As ProvenanceKinds().
  std::map<std::string, double> seconds;   // Per stage, where it is recorded.
  std::string note;         // Of its record: what it was refined by.
  bool has_sigma = false;   // Whether there is a picture of its sigma map.
  bool has_planes = false;  // Whether there is a picture of its planes.
  // The pictures that exist of those that only some runs have.
  std::vector<std::string> stages;
  PointSample points_before;
  PointSample points_after;
};

struct ImagePageOptions {
  int max_picture_size = 1000;  // Of the longer side, in pixels.
  // What --TsarRefine.debug_path was when the maps were made; may be empty.
  std::filesystem::path debug_path;
  bool show_planes = false;  // Of the images that have a plane map.
  // For the 3D view; 0 points for none.
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  int64_t max_num_points = 0;
};

// Of the pictures that --TsarRefine.debug_path made of an image, those that the
// page shows and that exist.
std::vector<RefineStage> FindStagePictures(
    const std::filesystem::path& debug_path, const std::string& image_name);

// Writes the pictures of a refined image into a new folder in `folder`, named
// by its number on the page. Throws Error: what ReadComparisonRow throws,
// kCorrupt and kMismatch for a confidence, sigma or plane map that is not one,
// kIo.
ImagePage WriteImagePage(const Workspace& workspace,
                         int image,
                         int number,
                         const std::filesystem::path& folder,
                         const ImagePageOptions& options);

}  // namespace tsar
