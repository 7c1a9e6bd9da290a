// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/discover_planes.h"

#include <cstdint>

namespace tsar {

// A view that looks at the same scene as the reference. Lengths are in units of
// the sparse model throughout.
struct ObservedSource {
  // Of its raster, in pixels of it.
  Intrinsics intrinsics;
  // From the reference camera's frame into its own.
  RelativePose from_reference;
  // Of its map, of which the raster may be a reduced one.
  DepthResolution resolution;
  int width = 0;  // Of its raster, in pixels.
  int height = 0;
  // As in ViewEvidence, of the size of the raster; each where it is asked for,
  // otherwise empty. Depths along its optical axis, 0 where nothing is certain.
  ImageView<const float> confident_depth;
  ImageView<const uint16_t> superpixels;  // The number of each pixel's.
};

// A point as a source view sees it.
struct SeenPoint {
  float depth = 0.f;  // Along the source's optical axis.
  float x = 0.f;      // Its place on the source's raster, in pixels,
  float y = 0.f;
  int column = 0;  // and the pixel there.
  int row = 0;
};

// Where a source sees a point, which is in the reference camera's frame. False
// where it does not see it, and `seen` is of no use then: behind the camera,
// beside its image, or where a coordinate is NaN. Whether something hides the
// point is not asked.
TSAR_HD inline bool FindInSource(const ObservedSource& source,
                                 const Vec3f& point,
                                 SeenPoint* seen) {
  const Vec3f position = source.from_reference * point;
  if (!(position.z > 0.f)) {
    return false;
  }
  seen->depth = position.z;
  source.intrinsics.Project(position, &seen->x, &seen->y);
  // As floats, since far outside they do not fit into integers.
  if (!(seen->x >= 0.f && seen->y >= 0.f && seen->x < source.width - 0.5f &&
        seen->y < source.height - 0.5f)) {
    return false;
  }
  seen->column = static_cast<int>(seen->x + 0.5f);
  seen->row = static_cast<int>(seen->y + 0.5f);
  return true;
}

// The source without its rasters. Both cameras are those of the views' rasters,
// with poses from the world into their frames.
ObservedSource MakeObservedSource(const ObservedView& reference,
                                  const ObservedView& source);

}  // namespace tsar
