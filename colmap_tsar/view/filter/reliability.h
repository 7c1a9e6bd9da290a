// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/matching_cost.h"

#include <cstdint>

namespace tsar {

struct ReliabilityOptions {
  // tau: the weight of n_cost relative to n_disp in n_aggr (Eq. 2).
  float confidence_weight = 0.7f;
  // The number of agreeing sources at which the agreement saturates.
  int saturating_agreement = 4;
};

// n_aggr of Eq. 2, tau n_cost + (1 - tau) n_disp, for pixels with a depth; 0
// for the others. Where agreement is not empty, (n_aggr + 2 min(agreeing
// sources, 4) / 4) / 3 replaces it: the number of agreeing views ranks pixels
// better than any cost, and both together rank best. Both are about 1 for
// correct pixels, so one threshold serves both. confidence and discontinuity
// may be empty (the ablation of the term): then the other one gets the full
// weight; without both, the score is the share of agreeing sources.
DeviceImage<float> AggregateScores(ImageView<const float> depth,
                                   ImageView<const float> confidence,
                                   ImageView<const float> discontinuity,
                                   ImageView<const uint8_t> agreement,
                                   const ReliabilityOptions& options,
                                   Device& device);

// 1 where the score is above eta, the least score of a reliable pixel; 0
// elsewhere.
DeviceImage<uint8_t> SelectReliable(ImageView<const float> score,
                                    float min_aggregated_score,
                                    Device& device);

// n_cost of Eq. 1 without its ratio c_min / c_sec, divided by its number of
// terms so that it lies in [0, 1]: the mean of (2 - c_min) / 2 and 1 - LRD. The
// ratio is high where two views agree; it compares two views at one plane, not
// two hypotheses, and without it the sum ranks pixels better on every scene.
// The LRD is left out where it is undefined; 0 where the cost is undefined,
// since the LRD of textureless windows is perfect but meaningless.
DeviceImage<float> ComputeConfidence(const MatchingCosts& costs,
                                     Device& device);

}  // namespace tsar
