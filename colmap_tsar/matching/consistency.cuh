// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/matching/views.h"

namespace tsar {

// Whether the point that pixel (x, y) sees has a reprojection error of at most
// max_error pixels through the source's depth map, and a triangulation angle
// whose cosine is at most this.
TSAR_HD inline bool IsConsistentWith(const Intrinsics& reference,
                                     const SourceView& source,
                                     int x,
                                     int y,
                                     const Vec3f& point,
                                     float max_error,
                                     float max_cos_angle) {
  SeenThroughSource seen;
  if (!LookThroughSource(reference, source, point, &seen)) {
    return false;
  }
  const float dx = seen.x - static_cast<float>(x);
  const float dy = seen.y - static_cast<float>(y);
  if (!(dx * dx + dy * dy <= max_error * max_error)) {
    return false;
  }
  // Directions from the point to the cameras.
  const RelativePose& pose = source.from_reference;
  const Vec3f to_source =
      -TransposeTimes(pose.rotation, pose.translation) - point;
  return Dot(-point, to_source) <=
         max_cos_angle * Norm(point) * Norm(to_source);
}

}  // namespace tsar
