// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The folder of the ground truth of a workspace: the given folder or, if empty,
// ground_truth/depth of the workspace.
std::filesystem::path GroundTruthFolder(
    const std::filesystem::path& workspace_path,
    const std::filesystem::path& given);

struct DepthEvaluationOptions {
  // The maps to score: "geometric" or "photometric".
  std::string input_type = "geometric";

  // Folder with IMAGE_NAME.bin, depth maps in COLMAP's format (0 = unknown), or
  // empty; see GroundTruthFolder.
  std::filesystem::path ground_truth_path;

  // The folder with the masks of images, see io/masks_and_labels.h; empty:
  // none. Masked pixels are not scored.
  std::filesystem::path mask_path;

  // The path of an image's map by the image's name; if not set, in
  // stereo/depth_maps of the workspace. The file need not exist.
  std::function<std::filesystem::path(const std::string& name)> find_map;

  // Upper bounds of the error of a correct depth, in units of the model;
  // positive and ascending.
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

}  // namespace tsar
