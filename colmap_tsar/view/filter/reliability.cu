// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/reliability.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

struct AggregateKernel {
  ImageView<const float> depth;
  ImageView<const float> confidence;
  ImageView<const float> discontinuity;
  ImageView<const uint8_t> agreement;
  ReliabilityOptions options;
  ImageView<float> score;

  TSAR_HD void operator()(int x, int y) const {
    if (!(depth(x, y) > 0.f)) {
      score(x, y) = 0.f;
      return;
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
    score(x, y) = sum;
  }
};

struct SelectKernel {
  ImageView<const float> score;
  float threshold;
  ImageView<uint8_t> reliable;

  TSAR_HD void operator()(int x, int y) const {
    reliable(x, y) = score(x, y) > threshold ? 1 : 0;
  }
};

}  // namespace

DeviceImage<float> AggregateScores(ImageView<const float> depth,
                                   ImageView<const float> confidence,
                                   ImageView<const float> discontinuity,
                                   ImageView<const uint8_t> agreement,
                                   const ReliabilityOptions& options,
                                   Device& device) {
  DeviceImage<float> score(device, depth.width, depth.height);
  ParallelFor(
      device,
      depth.width,
      depth.height,
      AggregateKernel{
          depth, confidence, discontinuity, agreement, options, score.View()});
  return score;
}

DeviceImage<uint8_t> SelectReliable(ImageView<const float> score,
                                    float min_aggregated_score,
                                    Device& device) {
  DeviceImage<uint8_t> reliable(device, score.width, score.height);
  ParallelFor(device,
              score.width,
              score.height,
              SelectKernel{score, min_aggregated_score, reliable.View()});
  return reliable;
}

}  // namespace tsar
