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

// A round of R1 that spreads depths, as in the paper: lays the planes of the
// superpixels over the map, smooths the result by the filter F_A, keeps it
// where the pixel's first disparity passes the gate around it (Eq. 9), and
// empties the others. A pixel without a score passes: mu / 0 is no bound.
// planes: on the map's pixels; filter: null for none; map: the depths of the
// round before, where trusted; all of the map's size. Changes map and trusted.
void SpreadRound(const PlaneRaster& planes,
                 ImageView<const Rgb> color,
                 const WeightedMedianOptions* filter,
                 const TrustGate& gate,
                 DepthNormalImages* map,
                 ImageView<uint8_t> trusted,
                 Device& device);

}  // namespace tsar
