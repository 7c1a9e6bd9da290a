// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>

// Functions common to the passes after the first, which continue from the maps
// of the previous pass; the last ones filter.
namespace tsar {

// Runs PatchMatch from the depth and normal of `view`. inputs: those with this
// view as reference.
PlaneMaps UpdateMaps(const ViewData& view,
                     const PatchMatchInputs& inputs,
                     const PatchMatchOptions& search,
                     Device& device);

// The options of the filter for an image with num_sources sources.
HypothesisFilterOptions FilterOptions(const StereoOptions& options,
                                      int num_sources);

// Filters the depths of the inputs' reference and, with smooth_normals, smooths
// its normals.
void FilterMaps(const PatchMatchInputs& inputs,
                const HypothesisFilterOptions& filter,
                bool smooth_normals,
                Device& device,
                PlaneMaps* maps);

}  // namespace tsar
