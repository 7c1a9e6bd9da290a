// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/superpixels/slic.h"

#include <cstdint>

namespace tsar {

// The result of R1: the trusted pixels, and the planes fitted to them.
struct CorrelationResult {
  // Nonzero where the pixel's own depth is trusted.
  DeviceImage<uint8_t> trusted;
  Buffer<Plane> planes;  // One per superpixel; may be invalid.
};

// R1 of the paper's iterative correlation refinement. Each round fits the
// superpixels' planes to the trusted pixels, replaces the map's depths by them,
// filters the result by F_A with a window that halves from round to round, and
// trusts the pixels whose own disparity is within mu / (n_aggr N_c) of it (Eq.
// 9). Trusted pixels keep their own depth. score: n_aggr; reliable: the pixels
// trusted initially; both of the map's size. image_id keys the random numbers.
CorrelationResult RefineByCorrelation(const DeviceViews& views,
                                      ImageView<const float> score,
                                      DeviceImage<uint8_t> reliable,
                                      const Superpixels& superpixels,
                                      const RefineOptions& options,
                                      uint32_t image_id,
                                      Device& device);

}  // namespace tsar
