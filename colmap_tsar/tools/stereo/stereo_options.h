// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// The options of tsar_stereo, on which its result depends; they have the names
// and meanings of COLMAP's patch_match_stereo where it has them.
struct StereoOptions {
  int max_image_size = -1;  // Longer side of the maps; -1: that of the images.
  double depth_min = -1.0;  // In units of the model; -1: from sparse points.
  double depth_max = -1.0;
  int num_sources = 20;  // At most; the first in patch-match.cfg.
  int window_radius = 5;
  int num_iterations = 4;
  // The sizes at which images are matched, each half the previous one.
  int num_levels = 2;
  bool geom_consistency = true;
  int num_geometric_passes = 2;  // Passes over all images.
  bool smooth_normals = true;    // In the geometric maps.
  // The filter of the geometric maps. COLMAP demands 3 degrees; here fusion and
  // refinement weigh depths by their precision, and the filter has to exclude
  // only sources so near to the reference that they agree at any depth.
  double filter_min_ncc = 0.1;
  double filter_min_triangulation_angle = 0.5;
  int filter_min_num_consistent = 2;
  double filter_geom_consistency_max_cost = 1.0;

  // Throws kBadOption with the option.
  void Check() const;

  // Text of all values and the program's version.
  std::string Text() const;
};

}  // namespace tsar
