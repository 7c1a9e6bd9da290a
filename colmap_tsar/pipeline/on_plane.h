// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/superpixels/samples.h"

namespace tsar {

// The depth of the plane that a raster has at a pixel of the map; 0 where it
// has none.
TSAR_HD inline float DepthOnPlane(const PlaneRaster& raster, int x, int y) {
  const Plane plane = raster.At(x, y);
  return plane.Valid() ? plane.Depth(raster.intrinsics.Ray(x, y)) : 0.f;
}

// Whether a depth is exactly that of the plane: then composition put it there.
TSAR_HD inline bool IsOnPlane(const PlaneRaster& raster,
                              int x,
                              int y,
                              float depth) {
  return depth > 0.f && depth == DepthOnPlane(raster, x, y);
}

}  // namespace tsar
