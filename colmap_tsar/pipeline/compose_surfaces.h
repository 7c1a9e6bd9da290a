// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/pipeline/compose.h"
#include "colmap_tsar/pipeline/device_views.h"
#include "colmap_tsar/pipeline/find_surfaces.h"
#include "colmap_tsar/pipeline/refine_options.h"

namespace tsar {

// The map of one view alone: its trusted depths and the planes of its
// superpixels and regions (may be empty). Takes the hypotheses of the views, or
// Surfaces::spread where it is there: the planes of superpixels are in it
// already.
ComposedMap ComposeSurfaces(const PlaneRaster& region_planes,
                            const RefineOptions& options,
                            Surfaces* surfaces,
                            DeviceViews* views,
                            Device& device);

}  // namespace tsar
