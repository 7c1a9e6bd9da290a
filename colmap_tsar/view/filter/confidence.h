// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/matching_cost.h"

namespace tsar {

struct ConfidenceOptions {
  // Whether to use c_min / c_sec as printed, which is high if two views agree.
  // It compares two views at one plane, not two hypotheses; without it the sum
  // ranks pixels better on every scene (docs/ablation.md).
  bool use_ratio = false;
  bool use_left_right_difference = true;
};

// n_cost of Eq. 1, divided by its number of terms so that it lies in [0, 1]:
// the mean of (2 - c_min) / 2, the ratio term and 1 - LRD. Terms without a
// second view are left out; 0 where the cost is undefined, since the ratio and
// the LRD of textureless windows are perfect but meaningless.
DeviceImage<float> ComputeConfidence(const MatchingCosts& costs,
                                     const ConfidenceOptions& options,
                                     Device& device);

}  // namespace tsar
