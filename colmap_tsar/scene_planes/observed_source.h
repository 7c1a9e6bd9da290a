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

// A view that looks at the same scene as the reference.
struct ObservedSource {
  Intrinsics intrinsics;
  RelativePose from_reference;
  DepthResolution resolution;
  int width = 0;  // Of its raster, on which the following lie.
  int height = 0;
  // As in ViewEvidence; each where it is asked for.
  ImageView<const float> confident_depth;
  ImageView<const uint16_t> superpixels;
};

// A point as a source view sees it.
struct SeenPoint {
  float depth = 0.f;
  float x = 0.f;  // Its place on the raster,
  float y = 0.f;
  int column = 0;  // and the pixel there.
  int row = 0;
};

// Where a view sees a point in the reference camera's frame; false where it
// does not: behind the camera or beside its image.
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

// The source without its rasters.
ObservedSource MakeObservedSource(const ObservedView& reference,
                                  const ObservedView& source);

}  // namespace tsar
