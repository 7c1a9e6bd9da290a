// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/stage_options.h"

#include <algorithm>
#include <cmath>

namespace tsar {

int ScaledLength(double length, double scale) {
  return std::max(1, static_cast<int>(std::lround(length * scale)));
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
