// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/view/regions/region_planes.h"

#include <cstdint>

namespace tsar {

// Removes each plane whose mean gap to its surroundings is max_gap or more (Eq.
// 16 as printed). The gap of a pixel on the region's border, one that has a
// neighbor outside of the region, is that between the plane's depth in the
// pixel and the mean depth of the samples in its eight neighbors; border pixels
// beside which there is no sample do not count, and without any the plane
// stays. samples: z = 0 for none; intrinsics: those of the regions' raster;
// max_gap: gamma, in the unit of the depths.
void RejectByBoundary(const Regions& regions,
                      ImageView<const RayDepth> samples,
                      const Intrinsics& intrinsics,
                      float max_gap,
                      Device& device,
                      RegionPlanes* planes);

}  // namespace tsar
