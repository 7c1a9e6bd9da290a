// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/superpixels/trust.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"

#include <cstdint>

namespace tsar {

DepthNormalImages CopyMap(const DepthNormalViews& map, Device& device);

// A round of R1 that propagates depths, as in the paper: replaces depths by the
// planes of the superpixels, filters the result by F_A, keeps it where the
// pixel's original disparity passes the gate around it (Eq. 9), and clears the
// others. A pixel of score 0 passes: mu / 0 is no bound. planes: on the map's
// pixels; filter: null for none; map: the trusted depths of the previous round;
// all of the map's size. Changes map and trusted.
void SpreadRound(const PlaneRaster& planes,
                 ImageView<const Rgb> color,
                 const WeightedMedianOptions* filter,
                 const TrustGate& gate,
                 DepthNormalImages* map,
                 ImageView<uint8_t> trusted,
                 Device& device);

}  // namespace tsar
