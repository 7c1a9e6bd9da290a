// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/update_maps.h"

#include "colmap_tsar/matching/plane_maps.h"

#include <algorithm>
#include <utility>

namespace tsar {

PlaneMaps UpdateMaps(const ViewData& view,
                     const PatchMatchInputs& inputs,
                     const PatchMatchOptions& search,
                     Device& device) {
  const Intrinsics& intrinsics = inputs.reference.intrinsics;
  const DeviceImage<float> depth(device, view.depth);
  const DeviceImage<Vec3f> normal(device, view.normal);
  const PlaneHypotheses found = RunPatchMatch(
      inputs,
      PlanesFromMaps(intrinsics, depth.View(), normal.View(), device),
      search,
      device);
  return MapsFromPlanes(intrinsics, found.planes.View(), device);
}

HypothesisFilterOptions FilterOptions(const StereoOptions& options,
                                      int num_sources) {
  HypothesisFilterOptions filter;
  filter.min_ncc = static_cast<float>(options.filter_min_ncc);
  filter.min_triangulation_angle =
      static_cast<float>(options.filter_min_triangulation_angle);
  filter.min_num_consistent =
      std::min(options.filter_min_num_consistent, num_sources);
  filter.geom_consistency_max_cost =
      static_cast<float>(options.filter_geom_consistency_max_cost);
  filter.window_radius = static_cast<float>(options.window_radius);
  return filter;
}

void FilterMaps(const PatchMatchInputs& inputs,
                const HypothesisFilterOptions& filter,
                bool smooth_normals,
                Device& device,
                PlaneMaps* maps) {
  ReferenceView view = inputs.reference;
  view.depth = std::as_const(maps->depth).View();
  view.normal = std::as_const(maps->normal).View();
  maps->depth =
      FilterHypotheses(view, inputs.sources, inputs.prior, filter, device);
  if (smooth_normals) {
    maps->normal = SmoothNormals(view.intrinsics,
                                 std::as_const(maps->depth).View(),
                                 std::as_const(maps->normal).View(),
                                 {},
                                 device);
  }
}

}  // namespace tsar
