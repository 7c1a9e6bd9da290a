// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene/surfaces/axis_camera.h"

#include <cstddef>
#include <vector>

namespace tsar {

// An edge across an axis in a row of the image of an AxisCamera.
struct AcrossEdge {
  float column = 0.f;    // With subpixel precision.
  float strength = 0.f;  // Slope of color, in gray levels per pixel.
};

// For each row of the rectified image the edges at local maxima of the color
// slope, in ascending order of columns. color: the view's raster.
std::vector<std::vector<AcrossEdge>> FindEdgesAcross(const Image<Rgb>& color,
                                                     const AxisCamera& camera);

// Whether the pixel of the rectified image lies in the view's raster, without a
// margin in which no edge is found.
bool IsInRaster(const AxisCamera& camera, double column, double row);

// Two straight edges parallel to an axis with nothing as strong between them,
// in the image of an AxisCamera: perhaps the outlines of a column or a pipe.
// Outlines are its occluding contours, which are different lines of its surface
// in each view.
struct OutlinePair {
  float left = 0.f;  // Columns.
  float right = 0.f;
  std::vector<int> rows;  // Rows with both edges, ascending.
};

// Finds outline pairs. edges: see FindEdgesAcross. Of pairs that share edges,
// those with the most rows take precedence.
std::vector<OutlinePair> FindOutlinePairs(
    const std::vector<std::vector<AcrossEdge>>& edges);

}  // namespace tsar
