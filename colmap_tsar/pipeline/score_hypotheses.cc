// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/score_hypotheses.h"

#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/filtering/confidence.h"
#include "colmap_tsar/filtering/confirmation.h"
#include "colmap_tsar/filtering/discontinuity.h"
#include "colmap_tsar/filtering/reliability.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/noise/estimate_noise.h"
#include "colmap_tsar/pipeline/stage_options.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

DeviceImage<float> RateMatches(const ViewData& reference,
                               const DeviceViews& views,
                               const RefineOptions& options,
                               Device& device,
                               StageObserver* observer) {
  MatchingCosts costs =
      ComputeMatchingCosts(views.Reference(), views.Sources(), device);
  if (!reference.min_cost.Empty()) {
    costs.min_cost = DeviceImage<float>(device, reference.min_cost);
    costs.second_cost = DeviceImage<float>(device, reference.second_cost);
  }
  DeviceImage<float> confidence =
      ComputeConfidence(costs, MakeConfidenceOptions(options), device);
  ShowStage(observer, RefineStage::kCost, costs.min_cost, device);
  ShowStage(observer, RefineStage::kMatchConfidence, confidence, device);
  return confidence;
}

}  // namespace

HypothesisScores ScoreHypotheses(const ViewData& reference,
                                 const DeviceViews& views,
                                 const RefineOptions& options,
                                 Device& device,
                                 StageTimer* timer,
                                 StageObserver* observer) {
  HypothesisScores result;
  DeviceImage<float> confidence;
  if (options.filter_confidence) {
    confidence = RateMatches(reference, views, options, device, observer);
  }
  DeviceImage<uint8_t> agreement;
  if (options.view_agreement) {
    agreement =
        CountAgreeingSources(views.Reference(), views.Sources(), {}, device);
    ShowStage(observer, RefineStage::kAgreement, agreement, device);
    if (options.confirmed_depths) {
      const NoiseCurve noise = EstimateNoise(views.Reference().gray, device);
      // What COLMAP's own check of consistency rejected is not confirmed by
      // chance.
      const DeviceImage<uint8_t> is_to_refine(device, reference.is_to_refine);
      result.confirmations = ConfirmDepths(views.Reference().gray,
                                           agreement.View(),
                                           is_to_refine.View(),
                                           noise,
                                           {},
                                           device);
    }
  }
  timer->Finish("matching");
  const ImageView<const float> depth = views.Hypotheses().depth;
  DeviceImage<float> discontinuity;
  if (options.filter_discontinuity) {
    discontinuity = ComputeDiscontinuity(depth, views.Scale(), {}, device);
    ShowStage(observer, RefineStage::kDiscontinuity, discontinuity, device);
  }
  ReliabilityOptions reliability;
  reliability.confidence_weight = static_cast<float>(options.confidence_weight);
  reliability.saturating_agreement = std::clamp(
      views.NumSourcesWithDepth(), 1, reliability.saturating_agreement);
  result.score = AggregateScores(depth,
                                 confidence.View(),
                                 discontinuity.View(),
                                 agreement.View(),
                                 reliability,
                                 device);
  return result;
}

int64_t ScoreHypothesesWorkingBytes(const RefineOptions& options,
                                    int64_t num_pixels) {
  const int64_t one_image = BytesOf<float>(num_pixels);
  // Three costs and the confidence; exported costs take the place of others.
  const int64_t matching = options.filter_confidence ? 4 * one_image : 0;
  const int64_t confidence = options.filter_confidence ? one_image : 0;
  const int64_t agreement =
      options.view_agreement ? BytesOf<uint8_t>(num_pixels) : 0;
  const int64_t confirmations = ConfirmationsBytes(options, num_pixels);
  const int64_t candidates_and_noise =
      confirmations > 0
          ? BytesOf<uint8_t>(num_pixels) + EstimateNoiseWorkingBytes(num_pixels)
          : 0;
  const int64_t layers = options.filter_discontinuity
                             ? ComputeDiscontinuityWorkingBytes(num_pixels)
                             : 0;
  const int64_t discontinuity = options.filter_discontinuity ? one_image : 0;
  return std::max(
      matching,
      confidence + agreement + confirmations +
          std::max({candidates_and_noise, layers, discontinuity + one_image}));
}

int64_t ConfirmationsBytes(const RefineOptions& options, int64_t num_pixels) {
  return options.view_agreement && options.confirmed_depths
             ? BytesOf<uint8_t>(num_pixels)
             : 0;
}

}  // namespace tsar
