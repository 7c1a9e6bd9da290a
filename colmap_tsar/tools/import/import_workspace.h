// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/tools/import/import_checks.h"
#include "colmap_tsar/tools/import/match_images.h"

#include <cstdint>
#include <filesystem>
#include <functional>
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
  // without the nearest and farthest 5 % of each image; 0 if none.
  float near = 0.f;
  float far = 0.f;
  float sparse_near = 0.f;
  float sparse_far = 0.f;
  // Warnings, one line each.
  std::vector<std::string> warnings;
};

// The frame of another program's normals.
enum class NormalFrame {
  kAuto,  // World for kAcm and kApd, camera for the others.
  kWorld,
  kCamera,
};

struct ImportOptions {
  std::filesystem::path workspace_path;
  // The files to import; match.type is also the type of the written maps.
  MatchOptions match;
  // Model units per stored unit of depth. 0: 0.001 for integers, otherwise 1.
  double depth_scale = 0.0;
  // Whether each image gets a separate scale from its sparse points.
  bool scale_to_sparse = false;
  // Whether to reject depths in other units than the sparse points.
  bool check_scale = true;
  NormalFrame normal_frame = NormalFrame::kAuto;
  // Whether to import costs. Those of other programs may include geometric
  // terms, and are noise in textureless areas.
  bool import_costs = false;
  // Whether to replace maps that another program wrote, which are kept.
  bool overwrite = false;
};

// Imports the maps of another program into a dense workspace, which needs only
// images/ and sparse/; the rest is created. Everything is read and checked
// before the first file is written. Maps may have another size than images, as
// COLMAP's.
//
// Throws Error, with nothing written: those of MatchImages, ReadExternalMaps,
// CheckCameras, RequireUnrefined, RequireNoForeignMaps, ReadSparseModel and
// WorkspaceLock, and kMismatch if a map's aspect ratio is not that of its
// image, depths are in other units than the sparse points, normals are in
// another frame than stated, or an image has too few sparse points for
// scale_to_sparse.
//
// should_stop: if given, called before each image. Once it returns true,
// kInterrupted is thrown; imported maps remain, and a new call starts over.
ImportSummary ImportWorkspace(const ImportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop = {});

}  // namespace tsar
