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

// The pixel among `to` pixels that covers the center of pixel i among `from`:
// where ground truth is looked up that is of another size than the map.
int NearestPixel(int i, int from, int to);

// Where the ground truth of a workspace lies: in the given folder, or, where
// that is empty, in ground_truth/depth of the workspace.
std::filesystem::path GroundTruthFolder(
    const std::filesystem::path& workspace_path,
    const std::filesystem::path& given);

struct DepthEvaluationOptions {
  // The maps to score: "geometric" or "photometric".
  std::string input_type = "geometric";

  // Folder with IMAGE_NAME.bin, depth maps in COLMAP's format (0 = unknown), or
  // empty; see GroundTruthFolder.
  std::filesystem::path ground_truth_path;

  // The folder with the masks of images, see io/image_mask.h; empty:
  // none. Masked pixels are not scored.
  std::filesystem::path mask_path;

  // Where the map of an image lies, by its name; if not set, in
  // stereo/depth_maps of the workspace. There need not be a file.
  std::function<std::filesystem::path(const std::string& name)> find_map;

  // A depth is right if it differs from the truth by less than this, in units
  // of the model; positive and rising.
  std::vector<double> tolerances = {0.02, 0.1};
};

// Numbers of pixels, over all images, that have ground truth and no mask.
struct DepthScore {
  std::string area;  // "all", or "textureless".
  double tolerance = 0;
  int64_t num_right = 0;
  int64_t num_estimated = 0;
  int64_t num_known = 0;

  double Precision() const;  // Right among estimated; 0 without any.
  double Recall() const;     // Right among known; 0 without any.
  double F1() const;
};

struct DepthEvaluation {
  int num_images = 0;
  int num_images_without_map = 0;  // They are left out of the scores.
  std::vector<DepthScore> scores;  // Per area, then per tolerance.
  // Of num_images, those with a mask; nothing where no masks were given.
  std::optional<int64_t> num_masks{};
};

// Scores the depth maps of a COLMAP workspace on all pixels and on those in
// textureless areas, where the standard deviation of gray in a window of 11 x
// 11 pixels is below 4 of 255 levels. Where map and ground truth differ in
// size, the ground truth is looked up at the map's pixels. Throws Error:
// kNotFound (no ground truth, or no maps), kMismatch (a map or an image is not
// of the shape of its ground truth), kBadOption (tolerances), and what
// ReadDepthMap, ReadGrayPhoto, FindImageMasks and ReadImageMask throw.
DepthEvaluation EvaluateDepthMaps(const std::filesystem::path& workspace_path,
                                  const DepthEvaluationOptions& options);

}  // namespace tsar
