// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_options.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"

namespace tsar {

void StereoOptions::Check() const {
  const bool has_min = depth_min != -1.0;
  const bool has_max = depth_max != -1.0;
  if (has_min != has_max ||
      (has_min && !(depth_min > 0.0 && depth_min < depth_max))) {
    throw Error(ErrorCode::kBadOption,
                OptionName("depth_min") + " and " + OptionName("depth_max") +
                    ": give both, with 0 < depth_min < depth_max, or neither");
  }
  if (max_image_size != -1 && max_image_size < 16) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("max_image_size") +
            ": give at least 16 pixels, or -1 for the size of the images");
  }
}

std::string StereoOptions::Text() const {
  TextStream text;
  text.precision(17);
  text << "version " << TSAR_VERSION << "\nmax_image_size " << max_image_size
       << "\ndepth_min " << depth_min << "\ndepth_max " << depth_max
       << "\nnum_sources " << num_sources << "\nwindow_radius " << window_radius
       << "\nnum_iterations " << num_iterations << "\nnum_levels " << num_levels
       << "\ngeom_consistency " << geom_consistency << "\nnum_geometric_passes "
       << num_geometric_passes << "\nsmooth_normals " << smooth_normals
       << "\nfilter_min_ncc " << filter_min_ncc
       << "\nfilter_min_triangulation_angle " << filter_min_triangulation_angle
       << "\nfilter_min_num_consistent " << filter_min_num_consistent
       << "\nfilter_geom_consistency_max_cost "
       << filter_geom_consistency_max_cost << "\n";
  return text.str();
}

}  // namespace tsar
