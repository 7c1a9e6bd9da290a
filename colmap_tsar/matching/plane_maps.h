// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"

// Conversions between planes of pixels and maps of depths and normals.
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

}  // namespace tsar
