// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/surfaces/curved_surfaces.h"

#include <cstdint>

namespace tsar {

// Replaces each pixel's plane by the tangent plane of its superpixel's surface,
// if any. superpixels: of `planes`' size; intrinsics: of this raster.
void RasterizeCurvedSurfaces(const CurvedView& curved,
                             const Image<uint16_t>& superpixels,
                             const Intrinsics& intrinsics,
                             Device& device,
                             DeviceImage<Plane>* planes);

}  // namespace tsar
