// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene/surfaces/axis_camera.h"

#include <cstddef>
#include <vector>

namespace tsar {

// Where the image changes across an axis, in a row of the image of an
// AxisCamera.
struct AcrossEdge {
  float column = 0.f;    // To a fraction of a pixel.
  float strength = 0.f;  // The slope of the colour, in grey levels per pixel.
};

// For each row of the rectified image the columns at which the colour changes
// most, in ascending order. color: the view's raster, of the camera that
// `axis_camera` was made of.
std::vector<std::vector<AcrossEdge>> FindEdgesAcross(
    const Image<Rgb>& color,
    const Camera& camera,
    const AxisCamera& axis_camera);

// Whether the view's raster, without a margin in which no edge is found, holds
// the pixel of the rectified image.
bool IsInRaster(const Camera& camera,
                const AxisCamera& axis_camera,
                double column,
                double row);

// Two straight edges parallel to an axis with nothing as strong between them,
// in the image of an AxisCamera: perhaps the outlines of a column or a pipe.
// Outlines are its occluding contours, at which it turns away from the camera:
// other lines of its surface in each view.
struct OutlinePair {
  float left = 0.f;  // Columns.
  float right = 0.f;
  std::vector<int> rows;  // In which both are seen, in ascending order.
};

// In pixels.
struct OutlinePairOptions {
  float min_width = 10.f;
  float max_width = 400.f;
  size_t min_rows = 20;
  // How far an edge may be from the pair's in a row that counts.
  float tolerance = 1.5f;
  // Edges between the two of a pair have less than this share of the strength
  // of the weaker one.
  float max_between = 0.6f;
};

// edges: see FindEdgesAcross. Of pairs that share edges, those that are seen in
// most rows come first.
std::vector<OutlinePair> FindOutlinePairs(
    const std::vector<std::vector<AcrossEdge>>& edges,
    const OutlinePairOptions& options);

}  // namespace tsar
