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
  // The options that select the fused pixels; point_spacing has to be 1.
  FusionOptions fusion = PresetFusionOptions(FusionPreset::kPaper);
  DeviceOptions devices;
  // Folder with IMAGE_NAME.bin, depth maps in COLMAP's format (0 = unknown);
  // empty: ground_truth/depth in the workspace.
  std::filesystem::path ground_truth_path;
  // A depth is right if it differs from the ground truth by less than this, in
  // units of the model; positive and increasing.
  std::vector<double> tolerances = {0.02, 0.1};
};

struct FusedPixelEvaluation {
  int num_images = 0;              // Images with ground truth.
  int64_t num_known = 0;           // Pixels with ground truth.
  int64_t num_fused = 0;           // Known pixels that became a point.
  std::vector<int64_t> num_right;  // Right fused pixels, by tolerance.
};

// The evaluation of the ablation in the TSAR-MVS paper (section 6.3.1): for
// each point of the fused cloud, the map's depth in the pixel that became the
// point is compared with the ground truth. The paper does not print the total
// of its percentages; shares here are of these pixels. Where map and ground
// truth differ in size, the ground truth is looked up at the map's pixels.
//
// Throws Error: kNotFound (no image has maps, or no fused image has ground
// truth), kMismatch (a ground truth is not of the shape of the map), kBadOption
// (tolerances, point_spacing), and what FusionRun and ReadDepthMap throw.
FusedPixelEvaluation EvaluateFusedPixels(
    const Workspace& workspace,
    const FusedPixelOptions& options,
    Progress& progress,
    const std::function<bool()>& should_stop);

}  // namespace tsar
