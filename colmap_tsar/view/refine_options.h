// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// The options on which a result depends besides the workspace; ListRefineFields
// describes the members, docs/ablation.md how each default was found. Values in
// pixels hold for maps 3110 pixels wide, the paper's size on ETH3D, and a
// segmentation raster 777 wide; they are scaled to the maps at hand.
struct RefineOptions {
  bool denoise = true;

  // Joint hypothesis filtering.
  bool filter = true;
  bool filter_confidence = true;
  bool filter_discontinuity = true;
  bool view_agreement = true;
  double min_aggregated_score = 0.8;  // eta
  double confidence_weight = 0.7;     // tau

  // Iterative correlation refinement.
  bool refine = true;
  bool superpixel_planes = true;
  bool weighted_median = true;
  bool readmit_filtered = false;
  int num_iterations = 4;             // N_t
  int superpixel_size = 400;          // S_sp
  double min_plane_support = 0.3;     // sigma
  int window_radius = 5;              // delta
  double spatial_sigma = 2.0;         // alpha
  double color_sigma = 3.0;           // beta
  double disparity_tolerance = 24.0;  // mu

  // Textureless-aware segmentation.
  bool segment = true;
  double edge_threshold = 4.0;
  int hough_max_gap = 15;  // upsilon
  bool region_cores = true;
  int max_region_planes = 4;
  int min_region_size = 8000;        // kappa * 10^4
  double max_boundary_error = 0.02;  // gamma, as a fraction of depth

  // Confirmation of measured depths.
  bool confirmed_depths = true;

  // Planes of the scene, consistent over the views.
  bool scene_planes = true;
  bool foreground_fattening = true;
  bool manhattan_frame = true;
  bool adjust_planes = true;
  bool bounded_planes = true;
  bool bounding_creases = true;
  bool cylinders = true;
  double plane_tolerance = 7.0;
  double min_scene_plane = 100.0;
  double unlabeled_cost = 0.02;

  // The minimum confidence of depths, and the minimum ConfidenceInSurface() of
  // depths that were not measured.
  double min_confidence = 0.0;
  double min_fill_confidence = 0.35;

  // Whether standard deviations of depths are written, too.
  bool sigma_maps = true;

  // Keys the random numbers of every RANSAC.
  int seed = 0;

  // Throws kBadOption with the option's name if a value is invalid.
  void Check() const;
};

}  // namespace tsar
