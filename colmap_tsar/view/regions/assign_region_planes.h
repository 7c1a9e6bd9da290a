// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/regions/regions.h"

namespace tsar {

// The plane of each pixel of a region: of several planes, the one with most
// samples nearby. Invalid further from the plane's support than
// max_extrapolation, and outside the regions.
DeviceImage<Plane> AssignRegionPlanes(const Regions& regions,
                                      const RegionPlanes& planes,
                                      ImageView<const RayDepth> samples,
                                      const Intrinsics& intrinsics,
                                      const DepthResolution& resolution,
                                      const RegionPlaneOptions& options,
                                      Device& device);

}  // namespace tsar
