// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/denoise/own_texture.h"

#include <cstdint>

namespace tsar {

struct HypothesisFilterOptions {
  // Names, meanings and defaults are those of COLMAP's patch_match_stereo.
  float min_ncc = 0.1f;
  float min_triangulation_angle = 3.f;    // Degrees, between the rays.
  int min_num_consistent = 2;             // Sources.
  float geom_consistency_max_cost = 1.f;  // Pixels of reprojection error.
  float window_radius = 5.f;              // Pixels.
  // How far a depth may lie off its prior, as a share of it, and its pixel's
  // own texture, in squared gray levels, from which it has to match
  // nevertheless.
  float prior_tolerance = 0.01f;
  float min_distinct_texture = kDistinctTexture;
};

// Keeps the depths that enough sources confirm: their image matches under the
// plane of depth and normal, their depth map leads back to the pixel, and their
// ray meets the reference's at an angle that tells depth. The others become 0.
// Confirm nothing: the reference itself among the sources, and sources without
// depth.
// prior: where maps were found with one, else empty. Of depths on their prior
// plane whose own texture is not distinct, the images need not match. If they
// do, it says little: the plane was preferred to others that match as well.
DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
                                    ImageView<const Plane> prior,
                                    const HypothesisFilterOptions& options,
                                    Device& device);

}  // namespace tsar
