// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

namespace tsar {

struct HypothesisFilterOptions {
  // These have the names and meanings of patch_match_stereo's options.
  float min_ncc = 0.1f;
  float min_triangulation_angle = 0.5f;   // Degrees, between the rays.
  int min_num_consistent = 2;             // Sources.
  float geom_consistency_max_cost = 1.f;  // Pixels of reprojection error.
  float window_radius = 5.f;              // Pixels.
};

// Keeps the depths that enough sources confirm: their image matches under the
// plane of depth and normal, their depth map reprojects to the pixel, and the
// triangulation angle suffices. The others become 0. The reference itself and
// sources without depth do not confirm any.
DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const SourceViews& sources,
                                    const HypothesisFilterOptions& options,
                                    Device& device);

}  // namespace tsar
