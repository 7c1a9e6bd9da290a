// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/confidence.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/matching/matching_cost.h"

namespace tsar {
namespace {

struct ConfidenceKernel {
  ImageView<const float> min_cost;
  ImageView<const float> second_cost;
  ImageView<const float> left_right_difference;
  ConfidenceOptions options;
  ImageView<float> confidence;

  TSAR_HD void operator()(int x, int y) const {
    const float min = min_cost(x, y);
    if (min == kUndefinedCost) {
      confidence(x, y) = 0.f;
      return;
    }
    float sum = 0.5f * (2.f - min);
    int num_terms = 1;
    const float second = second_cost(x, y);
    if (options.use_ratio && second != kUndefinedCost) {
      ++num_terms;
      // Two costs of 0 have no quotient; their ratio counts as 1.
      sum += second > 0.f ? min / second : 1.f;
    }
    // The LRD is undefined where the costs were read from a file and the
    // windows of this program lack contrast.
    const float difference = left_right_difference(x, y);
    if (options.use_left_right_difference && difference != kUndefinedCost) {
      ++num_terms;
      sum += 1.f - difference;
    }
    confidence(x, y) = sum / num_terms;
  }
};

}  // namespace

DeviceImage<float> ComputeConfidence(const MatchingCosts& costs,
                                     const ConfidenceOptions& options,
                                     Device& device) {
  DeviceImage<float> confidence(
      device, costs.min_cost.Width(), costs.min_cost.Height());
  ParallelFor(device,
              confidence.Width(),
              confidence.Height(),
              ConfidenceKernel{costs.min_cost.View(),
                               costs.second_cost.View(),
                               costs.left_right_difference.View(),
                               options,
                               confidence.View()});
  return confidence;
}

}  // namespace tsar
