// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

namespace tsar {

// The depth and normal of the planes at their pixels; 0 where there is none.
struct PlaneMaps {
  DeviceImage<float> depth;
  DeviceImage<Vec3f> normal;
};
PlaneMaps MapsFromPlanes(const Intrinsics& intrinsics,
                         ImageView<const Plane> planes,
                         Device& device);

// Resizes planes to another size of the same image by nearest-neighbor
// sampling.
DeviceImage<Plane> ResizePlanes(ImageView<const Plane> planes,
                                int width,
                                int height,
                                Device& device);

// Makes planes from depths and normals, for pixels that have a depth.
DeviceImage<Plane> PlanesFromMaps(const Intrinsics& intrinsics,
                                  ImageView<const float> depth,
                                  ImageView<const Vec3f> normal,
                                  Device& device);

struct SmoothNormalsOptions {
  int radius = 2;  // Radius of the window, in pixels.
  // The largest distance of a neighbor's depth from the pixel's plane, as a
  // fraction of depth, and the least cosine between normals of one surface.
  float max_depth_error = 0.01f;
  float min_cos_angle = 0.7f;
};

// Averages each normal with those of the same surface around it: stereo_fusion
// drops views whose normals differ by more than 10 degrees, which the noise of
// weakly textured windows exceeds. Pixels with depth 0 keep their normals.
DeviceImage<Vec3f> SmoothNormals(const Intrinsics& intrinsics,
                                 ImageView<const float> depth,
                                 ImageView<const Vec3f> normal,
                                 const SmoothNormalsOptions& options,
                                 Device& device);

}  // namespace tsar
