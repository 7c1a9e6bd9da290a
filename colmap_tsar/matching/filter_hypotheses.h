// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

namespace tsar {

// The bounds by which COLMAP's patch_match_stereo filters, under its names.
struct HypothesisFilterOptions {
  float min_ncc = 0.1f;
  float min_triangulation_angle = 3.f;    // In degrees.
  int min_num_consistent = 2;             // Sources.
  float geom_consistency_max_cost = 1.f;  // Pixels of reprojection error.
  float window_radius = 5.f;
};

// Keeps the depths that enough sources confirm: their image matches under the
// pixel's plane, their own depth leads back to the pixel, and they see the
// point from another direction. The other depths become 0.
DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
                                    const HypothesisFilterOptions& options,
                                    Device& device);

}  // namespace tsar
