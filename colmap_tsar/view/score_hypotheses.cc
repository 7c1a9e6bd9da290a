// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/score_hypotheses.h"

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"
#include "colmap_tsar/view/filter/confidence.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/stage_options.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

DeviceImage<float> ScoreMatches(const ViewData& reference,
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
    confidence = ScoreMatches(reference, views, options, device, observer);
  }
  DeviceImage<uint8_t> agreement;
  if (options.view_agreement) {
    agreement =
        CountAgreeingSources(views.Reference(), views.Sources(), {}, device);
    ShowStage(observer, RefineStage::kAgreement, agreement, device);
    if (options.confirmed_depths) {
      const NoiseCurve noise = EstimateNoise(views.Reference().gray, device);
      // Depths that COLMAP's consistency check rejected are no candidates, lest
      // they be confirmed by chance.
      const DeviceImage<uint8_t> is_to_refine(device, reference.is_to_refine);
      result.confirmations = ConfirmDepths(views.Reference().gray,
                                           agreement.View(),
                                           is_to_refine.View(),
                                           noise,
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

}  // namespace tsar
