// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/view/planes/group_planes.h"

namespace tsar {

// The plane of each superpixel from its reliable samples; invalid where a
// superpixel has too little support or its plane leaves [0.8 D_min, 1.2 D_max]
// at the superpixel's center (Eq. 4, whose printed bounds are empty).
// superpixels: the pixels of each; samples: reliable measurements on their
// raster, z = 0 elsewhere; intrinsics: those of that raster. min_support,
// sigma: the least share of a superpixel's pixels that must be reliable, and of
// its reliable pixels that must lie on the plane. ransac.tolerance: t_k of Eq.
// 5.
Buffer<Plane> FitSuperpixelPlanes(const PixelGroups& superpixels,
                                  ImageView<const RayDepth> samples,
                                  const Intrinsics& intrinsics,
                                  const DisparityScale& scale,
                                  float min_support,
                                  const GroupPlaneOptions& ransac,
                                  Device& device);

}  // namespace tsar
