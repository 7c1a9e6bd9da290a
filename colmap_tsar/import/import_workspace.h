// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/import/check_scale.h"
#include "colmap_tsar/import/match_images.h"

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace tsar {

// In which frame another program's normals are.
enum class NormalFrame {
  kAuto,  // World for kAcm and kApd, camera for the others.
  kWorld,
  kCamera,
};

struct ImportOptions {
  std::filesystem::path workspace_path;
  // What to import; match.type is the type of maps to write, too.
  MatchOptions match;
  // Model units per stored unit of depth. 0: 0.001 for depth images of
  // integers, otherwise 1.
  double depth_scale = 0.0;
  // Give each image a scale of its own, by its sparse points.
  bool scale_to_sparse = false;
  // Refuse depths that are in other units than the sparse points.
  bool check_scale = true;
  NormalFrame normal_frame = NormalFrame::kAuto;
  // Take costs over, too. What other programs write is not what tsar_refine
  // would compute: they may hold terms of geometry, and where the image has no
  // texture they are noise.
  bool import_costs = false;
  // Replace maps that another program wrote; they are kept.
  bool overwrite = false;
};

struct ImportSummary {
  std::filesystem::path workspace_path;
  MapType type = MapType::kGeometric;
  int num_images = 0;  // Of the sparse model.
  int num_imported = 0;
  int num_without_image = 0;  // Maps of images that the model does not hold.
  int num_with_normals = 0;   // Images whose normals came with them.
  int num_with_costs = 0;
  int64_t num_pixels = 0;
  int64_t num_with_depth = 0;
  // Ratios of depths to those of the sparse points, before scale_to_sparse.
  ScaleVerdict scale;
  bool has_own_scales = false;  // By scale_to_sparse.
  // The ranges of the written depths and of the sparse points in the images,
  // without the nearest and the farthest 5 % of each image; 0 where none are.
  float near = 0.f;
  float far = 0.f;
  float sparse_near = 0.f;
  float sparse_far = 0.f;
  // Things to look at, one line each.
  std::vector<std::string> warnings;
};

// Imports the maps of another program into a dense workspace, which needs
// images/ and sparse/ alone; the rest is made. Everything is read and checked
// before the first file is written. The maps have their own size, which may
// differ from the image's, as COLMAP's may.
//
// Throws Error, with nothing written: what MatchImages, ReadPriorMaps,
// CheckCameras, RequireUnrefined, RequireNoForeignMaps, ReadSparseModel and
// WorkspaceLock throw, and kMismatch where a map's shape is not that of its
// image, where depths are in other units than the sparse points or normals in
// another frame than said, or where an image has too few sparse points for
// scale_to_sparse.
ImportSummary ImportWorkspace(const ImportOptions& options, Progress& progress);

// A few lines for the user, with the next command to give.
void PrintSummary(const ImportSummary& summary, std::ostream& out);

}  // namespace tsar
