// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/stage_timer.h"
#include "colmap_tsar/view/superpixels/slic.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>

namespace tsar {

// The results of the single-view stages.
struct SingleViewResult {
  DeviceImage<float> score;  // n_aggr of Eq. 2, with the agreement of views.
  // The Confirmation of each hypothesis. Empty without
  // RefineOptions::confirmed_depths or view_agreement.
  DeviceImage<uint8_t> confirmations;
  DeviceImage<uint8_t> trusted;  // Nonzero where the hypothesis is trusted.
  // Empty without RefineOptions::refine.
  Superpixels superpixels;
  Buffer<Plane> superpixel_planes;
  // The regions' planes at the raster's pixels; empty without
  // RefineOptions::segment.
  DeviceImage<Plane> region_planes;
};

// Runs filtering, refinement and segmentation, the paper's three stages.
// Releases the sources of the views as early as possible.
SingleViewResult RunSingleViewStages(const ViewData& reference,
                                     uint32_t image_id,
                                     const RefineOptions& options,
                                     DeviceViews* views,
                                     Device& device,
                                     StageTimer* timer);

}  // namespace tsar
