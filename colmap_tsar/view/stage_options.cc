// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/stage_options.h"

#include <algorithm>
#include <cmath>

namespace tsar {

int ScaledLength(double length, double scale) {
  return std::max(1, static_cast<int>(std::lround(length * scale)));
}

CorrelationOptions MakeCorrelationOptions(const RefineOptions& options,
                                          uint32_t image_id) {
  CorrelationOptions result;
  result.num_iterations = options.num_iterations;
  result.window_radius = static_cast<float>(options.window_radius);
  result.disparity_tolerance = static_cast<float>(options.disparity_tolerance);
  result.spatial_sigma = static_cast<float>(options.spatial_sigma);
  result.color_sigma = static_cast<float>(options.color_sigma);
  result.readmit_filtered = options.readmit_filtered;
  result.use_superpixel_planes = options.superpixel_planes;
  result.use_weighted_median = options.weighted_median;
  result.planes.min_support = static_cast<float>(options.min_plane_support);
  result.planes.ransac.image_id = image_id;
  result.planes.ransac.seed = static_cast<uint32_t>(options.seed);
  return result;
}

HoughOptions MakeHoughOptions(const RefineOptions& options,
                              double raster_scale) {
  HoughOptions hough;
  hough.max_gap = ScaledLength(options.hough_max_gap, raster_scale);
  return hough;
}

int MinRegionSize(const RefineOptions& options, double raster_scale) {
  const double area_scale = raster_scale * raster_scale;
  return static_cast<int>(options.min_region_size * area_scale);
}

RegionPlaneOptions MakeRegionPlaneOptions(const RefineOptions& options,
                                          double raster_scale,
                                          uint32_t image_id) {
  RegionPlaneOptions planes;
  planes.max_planes = options.max_region_planes;
  planes.use_core = options.region_cores;
  planes.rim_width = ScaledLength(planes.rim_width, raster_scale);
  planes.core_margin = ScaledLength(planes.core_margin, raster_scale);
  planes.min_rim_share = static_cast<float>(options.min_plane_support);
  planes.max_boundary_error = static_cast<float>(options.max_boundary_error);
  planes.ransac.tolerance.pixels = 1.f;
  planes.ransac.num_hypotheses = 200;
  planes.ransac.image_id = image_id;
  planes.ransac.seed = static_cast<uint32_t>(options.seed);
  return planes;
}

}  // namespace tsar
