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
#include <cstdlib>
#include <utility>

namespace tsar {
namespace {

double TP(const char* n, double d) { return getenv(n) ? atof(getenv(n)) : d; }

DeviceImage<float> RateMatches(const ViewData& reference,
                               const DeviceViews& views,
                               const NoiseCurve& noise,
                               const RefineOptions& options,
                               Device& device,
                               StageObserver* observer) {
  MatchingCosts costs =
      ComputeMatchingCosts(views.Reference(), views.Sources(), noise, (float)TP("TP_K", 0), device);
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
  const NoiseCurve noise = EstimateNoise(views.Reference().gray, device);
  HypothesisScores result;
  DeviceImage<float> confidence;
  if (options.filter_confidence) {
    confidence =
        RateMatches(reference, views, noise, options, device, observer);
  }
  ViewAgreement agreement;
  if (options.view_agreement) {
    agreement =
        CountAgreeingSources(views.Reference(), views.Sources(), {}, device);
    ShowStage(observer, RefineStage::kAgreement, agreement.agreeing, device);
    if (options.confirmed_depths) {
      ConfirmationOptions co; co.min_texture = (float)TP("TP_V5", 4);
      // What COLMAP's own check of consistency rejected is not confirmed by
      // chance.
      const DeviceImage<uint8_t> is_to_refine(device, reference.is_to_refine);
      result.confirmations = CountConfirmations(views.Reference().gray,
                                                agreement.agreeing.View(),
                                                getenv("TP_MASK0") ? ImageView<const uint8_t>{} : is_to_refine.View(),
                                                noise,
                                                co,
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
                         agreement.agreeing.View(),
                         TP("TP_SEE", 0) != 0 ? std::as_const(agreement.seeing).View() : ImageView<const uint8_t>{},
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
  const int64_t layers = options.filter_discontinuity
                             ? ComputeDiscontinuityWorkingBytes(num_pixels)
                             : 0;
  const int64_t discontinuity = options.filter_discontinuity ? one_image : 0;
  return std::max(
      matching,
      confidence + agreement + std::max(layers, discontinuity + one_image));
}

}  // namespace tsar
