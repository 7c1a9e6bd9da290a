// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/fusion/fusion_options.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace tsar {

struct FusedPixelOptions {
  // Which pixels are fused; point_spacing has to be 1.
  FusionOptions fusion = PresetFusionOptions(FusionPreset::kPaper);
  DeviceOptions devices;
  // Folder with IMAGE_NAME.bin, depth maps in COLMAP's format (0 = unknown);
  // empty: ground_truth/depth in the workspace.
  std::filesystem::path ground_truth_path;
  // A depth is right if it differs from the truth by less than this, in units
  // of the model; positive and rising.
  std::vector<double> tolerances = {0.02, 0.1};
};

struct FusedPixelEvaluation {
  int num_images = 0;              // With ground truth.
  int64_t num_known = 0;           // Pixels with ground truth.
  int64_t num_fused = 0;           // Of these, those that became a point.
  std::vector<int64_t> num_right;  // Of these, by tolerance.
};

// After the ablation in the TSAR-MVS paper (section 6.3.1): of each point of
// the fused cloud one pixel is chosen, the one that became the point, and the
// depth that the map has there is compared with the truth. Which whole the
// paper's percentages are of is not printed; shares here are of these pixels.
// Where map and ground truth differ in size, the ground truth is looked up at
// the map's pixels.
//
// Throws Error: kNotFound (no image has maps, or none that is fused ground
// truth), kMismatch (a ground truth is not of the shape of the map), kBadOption
// (tolerances, point_spacing), and what FusionRun and ReadDepthMap throw.
FusedPixelEvaluation EvaluateFusedPixels(
    const Workspace& workspace,
    const FusedPixelOptions& options,
    Progress& progress,
    const std::function<bool()>& should_stop);

}  // namespace tsar
