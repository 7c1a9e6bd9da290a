// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/tools/import/check_scale.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// The results and warnings of an import.
struct ImportSummary {
  std::filesystem::path workspace_path;
  MapType type = MapType::kGeometric;
  int num_images = 0;  // Images of the sparse model.
  int num_imported = 0;
  int num_without_image = 0;  // Maps of images that the model does not hold.
  int num_with_normals = 0;   // Images with imported normals.
  int num_with_costs = 0;
  int64_t num_pixels = 0;
  int64_t num_with_depth = 0;
  // Ratios of depths to those of the sparse points, before scale_to_sparse.
  ScaleVerdict scale;
  bool has_own_scales = false;  // With scale_to_sparse.
  // The ranges of the written depths and of the sparse points in the images,
  // without the nearest and the farthest 5 % of each image; 0 if there are
  // none.
  float near = 0.f;
  float far = 0.f;
  float sparse_near = 0.f;
  float sparse_far = 0.f;
  // Warnings, one line each.
  std::vector<std::string> warnings;
};

}  // namespace tsar
