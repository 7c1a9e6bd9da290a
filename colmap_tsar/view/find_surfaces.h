// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/stage_timer.h"
#include "colmap_tsar/view/superpixels/slic.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>

namespace tsar {

// What one view tells about the surfaces that it sees.
struct Surfaces {
  DeviceImage<float> score;            // n_aggr of the hypotheses.
  DeviceImage<uint8_t> confirmations;  // HypothesisScores::confirmations.
  DeviceImage<uint8_t> trusted;  // Other than 0 where the hypothesis stands.
  // Empty without RefineOptions::refine.
  Superpixels superpixels;
  Buffer<Plane> superpixel_planes;
  // The depths of the trusted pixels with RefineOptions::spread_medians; else
  // empty.
  DepthNormalImages spread;
  // The map as R1 and R2 leave it with RefineOptions::fill_before_regions, to
  // which the regions were fitted; else empty. The hypotheses of the views or
  // `spread` went into it.
  ComposedMap filled;
  // The regions' planes at the raster's pixels; empty without
  // RefineOptions::segment.
  DeviceImage<Plane> region_planes;
};

// Filtering, refinement and segmentation, the paper's three stages.
// Lets the sources of the views go as soon as it can. observer: may be null.
Surfaces FindSurfaces(const ViewData& reference,
                      uint32_t image_id,
                      const RefineOptions& options,
                      DeviceViews* views,
                      Device& device,
                      StageTimer* timer,
                      StageObserver* observer);

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
