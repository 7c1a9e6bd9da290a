// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

namespace tsar {

// The depth and normal of the planes at their pixels; 0 where there is none.
DepthNormalImages MapsFromPlanes(const Intrinsics& intrinsics,
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

// Averages each normal with those of the same surface around it: stereo_fusion
// drops views whose normals differ by more than 10 degrees, which the noise of
// weakly textured windows exceeds. Pixels with depth 0 keep their normals.
DeviceImage<Vec3f> SmoothNormals(const Intrinsics& intrinsics,
                                 ImageView<const float> depth,
                                 ImageView<const Vec3f> normal,
                                 Device& device);

}  // namespace tsar
