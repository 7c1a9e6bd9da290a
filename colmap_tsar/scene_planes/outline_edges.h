// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene_planes/axis_camera.h"

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

}  // namespace tsar
