// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/reliability.h"

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/matching_cost.h"

namespace tsar {
namespace {

struct AggregateKernel {
  ImageView<const float> depth;
  ImageView<const float> confidence;
  ImageView<const float> discontinuity;
  ImageView<const uint8_t> agreement;
  ReliabilityOptions options;

  TSAR_HD float operator()(int x, int y) const {
    if (!(depth(x, y) > 0.f)) {
      return 0.f;
    }
    const float tau = confidence.Empty()      ? 0.f
                      : discontinuity.Empty() ? 1.f
                                              : options.confidence_weight;
    float sum = 0.f;
    if (!confidence.Empty()) {
      sum += tau * confidence(x, y);
    }
    if (!discontinuity.Empty()) {
      sum += (1.f - tau) * discontinuity(x, y);
    }
    if (!agreement.Empty()) {
      const int count = agreement(x, y) < options.saturating_agreement
                            ? agreement(x, y)
                            : options.saturating_agreement;
      const float share =
          static_cast<float>(count) / options.saturating_agreement;
      sum = confidence.Empty() && discontinuity.Empty()
                ? share
                : (sum + 2.f * share) / 3.f;
    }
    return sum;
  }
};

struct SelectKernel {
  ImageView<const float> score;
  float threshold;

  TSAR_HD uint8_t operator()(int x, int y) const {
    return score(x, y) > threshold ? 1 : 0;
  }
};

struct ConfidenceKernel {
  ImageView<const float> min_cost;
  ImageView<const float> left_right_difference;

  TSAR_HD float operator()(int x, int y) const {
    const float min = min_cost(x, y);
    if (min == kUndefinedCost) {
      return 0.f;
    }
    float sum = 0.5f * (2.f - min);
    int num_terms = 1;
    // The LRD is undefined where the costs were read from a file and the
    // windows of this program lack contrast.
    const float difference = left_right_difference(x, y);
    if (difference != kUndefinedCost) {
      ++num_terms;
      sum += 1.f - difference;
    }
    return sum / num_terms;
  }
};

}  // namespace

DeviceImage<float> AggregateScores(ImageView<const float> depth,
                                   ImageView<const float> confidence,
                                   ImageView<const float> discontinuity,
                                   ImageView<const uint8_t> agreement,
                                   const ReliabilityOptions& options,
                                   Device& device) {
  return MapPixels<float>(
      device,
      depth.width,
      depth.height,
      AggregateKernel{depth, confidence, discontinuity, agreement, options});
}

DeviceImage<uint8_t> SelectReliable(ImageView<const float> score,
                                    float min_aggregated_score,
                                    Device& device) {
  return MapPixels<uint8_t>(device,
                            score.width,
                            score.height,
                            SelectKernel{score, min_aggregated_score});
}

DeviceImage<float> ComputeConfidence(const MatchingCosts& costs,
                                     Device& device) {
  return MapPixels<float>(device,
                          costs.min_cost.Width(),
                          costs.min_cost.Height(),
                          ConfidenceKernel{costs.min_cost.View(),
                                           costs.left_right_difference.View()});
}

}  // namespace tsar
