// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

struct ReliabilityOptions {
  // tau: the weight of n_cost against n_disp in n_aggr (Eq. 2).
  float confidence_weight = 0.7f;
  // How many agreeing sources are as good as any number of them.
  int saturating_agreement = 4;
};

// n_aggr of Eq. 2, tau n_cost + (1 - tau) n_disp, for pixels with a depth; 0
// for the others. Where agreement is not empty, (n_aggr + 2 min(agreeing
// sources, 4) / 4) / 3 takes its place: the number of views that see the same
// depth ranks pixels better than any cost, and the two together best. Both are
// about 1 for pixels that are right, so that one threshold serves both.
// confidence and discontinuity may be empty (the ablation of the term): then
// the other one takes the whole weight; without both, the share of agreeing
// sources is the score.
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

}  // namespace tsar
