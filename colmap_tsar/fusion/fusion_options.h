// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// Which depth a fused point takes from the pixels that agree on it.
enum class FusionStatistic : int32_t {
  kWeighted,  // Their mean by confidence / sigma^2.
  kMean,
  kMedian,
};

// When pixels of different images show one point.
struct FusionOptions {
  FusionStatistic statistic = FusionStatistic::kWeighted;
  // How many images have to agree on a point, that of the pixel included.
  int min_num_views = 2;
  // How far a pixel may lie from where the other image's depth leads back to,
  // in pixels.
  double max_reproj_error = 2.0;
  // How far depths may differ, relative to the depth of the other image.
  double max_depth_error = 0.01;
  double max_normal_error = 30.0;  // Degrees, below 90.
  // Leaves out points that are less certain by the images that agree than by
  // those that see through them, each by the confidence of its depth there.
  bool reject_contradicted = true;
  // Other images that are asked about a point: those that share most sparse
  // points, then those of patch-match.cfg. At most kMaxFusionSources.
  int check_num_images = 20;
  // Of each square of so many pixels of an image, the one in the middle becomes
  // a point.
  int point_spacing = 2;

  // Throws kBadOption, naming the option.
  void Check() const;
};

// The sources of one image are the bits of a number.
constexpr int kMaxFusionSources = 64;
constexpr int kMaxPointSpacing = 1000;

enum class FusionPreset {
  kDefault,
  // What the TSAR-MVS paper prints of its fusion (section 5): depths within 1 %,
  // normals within 30 degrees, reprojection errors of 2 pixels at most, more
  // than one other view that agrees, and the mean of all.
  kPaper,
  // The thresholds of COLMAP's stereo_fusion, and medians.
  kColmap,
};

// "default", "paper" and "colmap", in the order of FusionPreset.
const std::vector<std::string>& FusionPresetNames();

// Throws kBadOption where there is no such preset.
FusionPreset ParseFusionPreset(const std::string& name);

FusionOptions PresetFusionOptions(FusionPreset preset);

}  // namespace tsar
