// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/macros.h"

#include <vector>

namespace tsar {

// The long side of the paper's ETH3D images, to which its values in pixels
// refer.
constexpr int kPaperSize = 3110;

// The resolution of the depths of a map: one pixel of disparity, which bounds
// the precision of matching.
struct DepthResolution {
  float error_per_depth = 0.f;  // 1 / (f b), f in pixels of the map itself

  // The relative depth change of one pixel of the map:
  // u(z) = clip(z / (f b), 0.002, 0.02).
  TSAR_HD float RelativeDepthError(float depth) const {
    const float error = depth * error_per_depth;
    return error < 0.002f ? 0.002f : (error > 0.02f ? 0.02f : error);
  }
};

// Converts depth to disparity in the paper's pixels: dp = focal length *
// baseline / depth, scaled from the map's long side to 3110. Thresholds on it
// depend neither on the scene's scale nor on the image's size.
struct DisparityScale : DepthResolution {
  float factor = 0.f;  // paper pixels times depth

  TSAR_HD float ToDisparity(float depth) const { return factor / depth; }
};

// The scale for a reference camera of the map's size. The baseline is the mean
// of the four shortest ones to the sources, ignoring sources with the same
// center, such as faces of a panorama; the factor is 0 if there are no others.
DisparityScale ComputeDisparityScale(const Camera& reference,
                                     const std::vector<Camera>& sources);

}  // namespace tsar
