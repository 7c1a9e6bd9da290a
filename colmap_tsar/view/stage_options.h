// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/regions/region_planes.h"

#include <cstdint>

namespace tsar {

// A length in pixels, at least 1, at another scale.
int ScaledLength(double length, double scale);

// The options of single stages from the options of a run. raster_scale: that of
// DeviceViews; lengths scale by it, areas by its square. image_id keys the
// random numbers.

// The least number of pixels of a region on the raster.
int MinRegionSize(const RefineOptions& options, double raster_scale);

RegionPlaneOptions MakeRegionPlaneOptions(const RefineOptions& options,
                                          double raster_scale,
                                          uint32_t image_id);

}  // namespace tsar
