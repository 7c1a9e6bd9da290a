// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <vector>

namespace tsar {

// The criteria by which pixels of different images show the same point.
struct FusionOptions {
  // Weights the depths that agree on a point by confidence / sigma^2; without
  // it, all count the same in their mean.
  bool weights_depths = true;
  // The number of images that have to agree on a point, its own included.
  int min_num_views = 2;
  // The largest distance of a pixel from the reprojection of the other image's
  // depth, in pixels.
  double max_reproj_error = 2.0;
  // The largest difference of depths, relative to that of the other image.
  double max_depth_error = 0.01;
  double max_normal_error = 30.0;  // Degrees, below 90.
  // Leaves out points where the images that see through them have more than a
  // third of the confidences of those that agree.
  bool reject_contradicted = true;
  // The number of sources of an image: those that share most sparse points,
  // then those of patch-match.cfg. At most kMaxFusionSources.
  int check_num_images = 20;
  // The side, in pixels, of the squares whose middle pixels become points.
  int point_spacing = 2;

  // Throws kBadOption, naming the option.
  void Check() const;
};

// The sources of one image are the bits of an integer.
constexpr int kMaxFusionSources = 64;
constexpr int kMaxPointSpacing = 1000;

// "default" and "paper".
const std::vector<std::string>& FusionPresetNames();

// "paper": the values in the TSAR-MVS paper (section 5): depths within 1 %,
// normals within 30 degrees, reprojection errors of 2 pixels at most, more than
// one other view that agrees, and the mean of all. Throws kBadOption where
// there is no such preset.
FusionOptions PresetFusionOptions(const std::string& name);

}  // namespace tsar
