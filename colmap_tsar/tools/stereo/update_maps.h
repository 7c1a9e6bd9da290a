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

// What the passes after the first have in common: they go on from the maps of
// the pass before, and the last ones filter.
namespace tsar {

// PatchMatch that begins with the depth and normal of `view`. inputs: of this
// view, as its reference.
PlaneMaps UpdateMaps(const ViewData& view,
                     const PatchMatchInputs& inputs,
                     const PatchMatchOptions& search,
                     Device& device);

// What confirms the depths of an image with so many sources.
HypothesisFilterOptions FilterOptions(const StereoOptions& options,
                                      int num_sources);

// Filters the depths of the inputs' reference and, if asked for, smooths its
// normals.
void FilterMaps(const PatchMatchInputs& inputs,
                const HypothesisFilterOptions& filter,
                bool smooth_normals,
                Device& device,
                PlaneMaps* maps);

}  // namespace tsar
