// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/matching_cost.h"

namespace tsar {

// How the quotient c_min / c_sec of Eq. 1 counts.
enum class RatioTerm {
  kNone,        // Left out.
  kSimilarity,  // c_min / c_sec, as printed: two views that agree are good.
  kAmbiguity,   // 1 - c_min / c_sec, the usual sign of a peak ratio.
};

struct ConfidenceOptions {
  // c_min / c_sec compares two views at one plane, not two hypotheses; without
  // it the sum ranks pixels better on every scene (docs/ablation.md).
  RatioTerm ratio_term = RatioTerm::kNone;
  bool use_left_right_difference = true;
};

// n_cost of Eq. 1, divided by its number of terms so that it lies in [0, 1]:
// the mean of (2 - c_min) / 2, the ratio term and 1 - LRD. Terms for which
// there is no second view are left out; 0 where the cost is undefined, since the
// ratio and the LRD of windows without texture look perfect and mean nothing.
DeviceImage<float> ComputeConfidence(const MatchingCosts& costs,
                                     const ConfidenceOptions& options,
                                     Device& device);

}  // namespace tsar
