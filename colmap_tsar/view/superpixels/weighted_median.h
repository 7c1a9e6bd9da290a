// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

struct WeightedMedianOptions {
  // Half the window's side in pixels of the map; 11 x 11 taps are distributed
  // over it.
  float radius = 10.f;
  // alpha and beta of Eq. 6: the weight of a tap is
  // exp(-distance / alpha^2 - |color difference| / beta^2), with the distance
  // in units of the spacing of the taps and colors 0-255.
  float spatial_sigma = 2.f;
  float color_sigma = 3.f;
  // The least share of the taps inside the image that must hold a depth.
  float min_support = 0.f;
};

// A radius given for the paper's image size, in pixels of a map.
inline float ScaledRadius(float radius, int width, int height) {
  return radius * (width > height ? width : height) / kPaperSize;
}

// The edge-preserving filters F_A and F_B. Each tap is a plane; its depth on
// the pixel's own ray is used, which preserves slanted planes. The result is
// the weighted median of these depths (by disparity, whose order is the reverse
// of depth's) and the weighted mean normal of the taps that agree with it; 0
// where too few taps hold a depth. where: nonzero at pixels to compute, all
// others get 0; empty: all pixels.
DepthNormalImages WeightedMedianFilter(const DepthNormalViews& input,
                                       ImageView<const Rgb> color,
                                       ImageView<const uint8_t> where,
                                       const Intrinsics& intrinsics,
                                       const WeightedMedianOptions& options,
                                       Device& device);

}  // namespace tsar
