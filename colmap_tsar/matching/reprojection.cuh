// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/matching/views.h"

namespace tsar {

// Finds the pixel of a raster that a point in its camera's frame projects to.
// Returns false if the point is behind the camera, outside the raster or NaN.
TSAR_HD inline bool FindPixel(const Intrinsics& intrinsics,
                              int width,
                              int height,
                              const Vec3f& point,
                              int* column,
                              int* row) {
  if (!(point.z > 0.f)) {
    return false;
  }
  float u = 0.f;
  float v = 0.f;
  intrinsics.Project(point, &u, &v);
  if (!(u >= -0.5f) || !(v >= -0.5f) || !(u < width - 0.5f) ||
      !(v < height - 0.5f)) {
    return false;
  }
  *column = static_cast<int>(u + 0.5f);
  *row = static_cast<int>(v + 0.5f);
  return true;
}

// The surface point of a source at the projection of a given point, in the
// reference's frame, with its pixel there.
struct SeenThroughSource {
  Vec3f point;
  float x = 0.f;
  float y = 0.f;

  // Whether the reprojection error of a pixel is at most this, in pixels.
  TSAR_HD bool IsWithin(float max_error, int column, int row) const {
    const float dx = x - static_cast<float>(column);
    const float dy = y - static_cast<float>(row);
    return dx * dx + dy * dy <= max_error * max_error;
  }
};

// Returns false if the source does not see the point or has no depth there.
TSAR_HD inline bool LookThroughSource(const Intrinsics& reference,
                                      const SourceView& source,
                                      const Vec3f& point,
                                      SeenThroughSource* seen) {
  const RelativePose& pose = source.from_reference;
  int column = 0;
  int row = 0;
  if (!FindPixel(source.intrinsics,
                 source.depth.width,
                 source.depth.height,
                 pose * point,
                 &column,
                 &row)) {
    return false;
  }
  const float source_depth = source.depth(column, row);
  if (!(source_depth > 0.f)) {
    return false;
  }
  seen->point = TransposeTimes(
      pose.rotation,
      source.intrinsics.Ray(column, row) * source_depth - pose.translation);
  if (!(seen->point.z > 0.f)) {
    return false;
  }
  reference.Project(seen->point, &seen->x, &seen->y);
  return true;
}

}  // namespace tsar
