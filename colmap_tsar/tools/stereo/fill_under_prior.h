// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <vector>

// Filling of textureless surfaces without measurements under the planar prior.
// Measured depths stay bit-identical, and filled ones have no evidence
// (kCostWithoutEvidence in the final maps), so that a refinement, which knows
// more of the scene's planes, does not treat them as measured.
namespace tsar {

// Fills pixels without a depth by that of their prior plane, if it lies in the
// range, and marks them by kUndefinedCost, which no measured pixel has: one
// without a defined cost has kCostWithoutEvidence. prior: of the maps' size.
void FillWithPrior(const Image<Plane>& prior,
                   const Intrinsics& intrinsics,
                   const DepthInterval& range,
                   StereoMaps* maps);

// Matches the pixels that FillWithPrior filled, with their depth and normal as
// prior, and keeps the depths that the sources' depths, including filled ones,
// confirm. Filled pixels are those of the reference whose min_cost is
// kUndefinedCost.
StereoMaps MatchUnderPrior(const ViewData& reference,
                           const std::vector<const ViewData*>& sources,
                           const DepthInterval& range,
                           uint32_t stream,
                           const StereoOptions& options,
                           Device& device);

}  // namespace tsar
