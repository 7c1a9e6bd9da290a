// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/tools/import/import_checks.h"
#include "colmap_tsar/tools/import/match_images.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// The results and warnings of an import.
struct ImportSummary {
  std::filesystem::path output_path;
  MapType type = MapType::kGeometric;
  int num_images = 0;  // Images of the sparse model.
  int num_imported = 0;
  int num_without_image = 0;  // Maps of images that the model does not hold.
  int num_with_normals = 0;   // Images with imported normals.
  int64_t num_pixels = 0;
  int64_t num_with_depth = 0;  // Pixels with depth before the filter, and
  int64_t num_kept = 0;        // in the written maps.
  // Ratios of depths to those of the sparse points, before scale_to_sparse.
  ScaleVerdict scale;
  bool has_own_scales = false;  // With scale_to_sparse.
  // Warnings, one line each.
  std::vector<std::string> warnings;
};

struct ImportOptions {
  // Only its images/ and sparse/ are read, and nothing is changed.
  std::filesystem::path workspace_path;
  std::filesystem::path output_path;
  // The files to import; match.type is also the type of the written maps.
  MatchOptions match;
  // Model units per stored unit of depth. 0: 0.001 for integers, otherwise 1.
  double depth_scale = 0.0;
  // Whether each image gets a separate scale from its sparse points.
  bool scale_to_sparse = false;
  // Whether to reject depths in other units than the sparse points.
  bool check_scale = true;
  // Whether to replace a workspace that an import made.
  bool overwrite = false;
  DeviceOptions device;  // For the filter of kAcm and kApd.
};

// Reads the sparse model of a workspace of which only images/ and sparse/ need
// exist. Throws Error: kNotFound (one is missing or empty), kUnsupported (an
// image's name leaves the folder), those of ReadSparseModel.
SparseModel ReadTargetModel(const std::filesystem::path& root);

// Makes a dense workspace of the photos and the sparse model of another one and
// the maps of another program; it appears when it is complete. Everything is
// read and checked before the first map is written. Maps may have another size
// than images, as COLMAP's. The geometric maps of kAcm and kApd, which do not
// filter theirs, are filtered (see FilterMaps).
//
// Throws Error, with nothing written: those of MatchImages, ReadExternalMaps,
// CheckCameras, ReadSparseModel, RequireOutsideInputs, OutputFolder and
// FilterMaps, and kMismatch if a map's aspect ratio is not that of its image,
// depths are in other units than the sparse points, or an image has too few
// sparse points for scale_to_sparse.
//
// Throws kInterrupted where the user asked to stop.
ImportSummary ImportWorkspace(const ImportOptions& options, Progress& progress);

}  // namespace tsar
