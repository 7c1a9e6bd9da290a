// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/fusion/fusion_options.h"
#include "colmap_tsar/run/device_options.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

struct DepthEvaluationOptions {
  MapType input_type = MapType::kGeometric;  // The maps to score.
  // Folder with IMAGE_NAME.bin, depth maps in COLMAP's format (0 = unknown);
  // empty: ground_truth/depth in the workspace.
  std::filesystem::path ground_truth_path;
  // Folder of masks (io/image_masks.h), or empty. Masked pixels do not
  // count.
  std::filesystem::path mask_path;
  // Depths with smaller errors are correct; in model units, ascending, > 0.
  std::vector<double> tolerances = {0.02, 0.1};
};

// Numbers of pixels, over all images, that have ground truth and no mask.
struct DepthScore {
  std::string area;  // "all", or "textureless".
  double tolerance = 0;
  int64_t num_right = 0;
  int64_t num_estimated = 0;
  int64_t num_known = 0;

  double Precision() const;  // Correct / estimated; 0 if none.
  double Recall() const;     // Correct / known; 0 if none.
  double F1() const;
};

struct DepthEvaluation {
  int num_images = 0;
  int num_images_without_map = 0;  // Excluded from the scores.
  std::vector<DepthScore> scores;  // Per area, then per tolerance.
  // The number of the num_images with a mask; nullopt without masks.
  std::optional<int64_t> num_masks{};
};

// Scores the depth maps of a COLMAP workspace on all pixels and on those in
// textureless areas, where the standard deviation of gray in a window of 11 x
// 11 pixels is below 4 of 255 levels. Where map and ground truth differ in
// size, the ground truth is looked up at the map's pixels. Throws Error:
// kNotFound (no ground truth, or no maps), kMismatch (the aspect ratio of a map
// or an image is not that of its ground truth), kBadOption (tolerances), and
// those of ReadDepthMap, ReadGrayPhoto, FindImageMasks and ReadImageMask.
DepthEvaluation EvaluateDepthMaps(const std::filesystem::path& workspace_path,
                                  const DepthEvaluationOptions& options);

struct FusedPixelEvaluation {
  int num_images = 0;              // Images with ground truth.
  int64_t num_known = 0;           // Pixels with ground truth.
  int64_t num_fused = 0;           // Known pixels that became a point.
  std::vector<int64_t> num_right;  // Right fused pixels, by tolerance.
};

// The evaluation of the ablation in the TSAR-MVS paper (section 6.3.1): for
// each point of the cloud that the maps of the workspace's type and its masks
// give by these options (the paper's are a preset), the map's depth in the
// pixel that became the point is compared with the ground truth. Where map and
// ground truth differ in size, the ground truth is looked up at the map's
// pixels.
//
// Throws Error: kNotFound (no image has maps, or no fused image has ground
// truth), kMismatch (a ground truth is not of the shape of the map), kBadOption
// (tolerances), and what FuseImages and ReadDepthMap throw.
FusedPixelEvaluation EvaluateFusedPixels(const Workspace& workspace,
                                         const DepthEvaluationOptions& options,
                                         const FusionOptions& fusion,
                                         const DeviceOptions& devices,
                                         Progress& progress);

}  // namespace tsar
