// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_confidence.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// The log-odds of a depth being right: a constant, and how much each measure of
// the label counts. The margin of a label contains what it gains by the other
// views that confirm it, which is why these count against it beside the margin.
struct LogOdds {
  float constant = 0.f;
  float explained = 0.f;
  float strength = 0.f;
  float confirmed = 0.f;
  float uncertainty = 0.f;
  float margin = 0.f;

  float Probability(const LabelQuality& quality) const {
    const float log_odds = constant + explained * quality.explained.Value() +
                           strength * quality.strength.Value() +
                           confirmed * quality.confirmed.Value() +
                           uncertainty * quality.uncertainty.Value() +
                           margin * quality.margin.Value();
    return std::clamp(1.f / (1.f + std::exp(-log_odds)),
                      kMinConfidence,
                      1.f - kMinConfidence);
  }
};

constexpr LogOdds kMoved = {.constant = 0.90f,
                            .confirmed = -1.26f,
                            .uncertainty = -4.21f,
                            .margin = 5.46f};
constexpr LogOdds kFilledByMeasured = {.constant = 0.26f,
                                       .confirmed = -4.34f,
                                       .uncertainty = -4.35f,
                                       .margin = 9.17f};
// Planes that the view itself did not measure there.
constexpr LogOdds kFilledByOthers = {.constant = -0.50f,
                                     .strength = 3.62f,
                                     .confirmed = -7.82f,
                                     .uncertainty = -2.46f,
                                     .margin = 11.45f};
constexpr LogOdds kStanding = {
    .constant = -0.30f, .explained = -0.29f, .margin = 1.59f};
constexpr LogOdds kStandingWeakly = {
    .constant = -0.68f, .explained = -2.04f, .margin = 0.11f};

}  // namespace

SurfaceConfidence RateSurface(LabelEvidence evidence,
                              const LabelQuality& quality) {
  const LogOdds& filled = evidence == LabelEvidence::kMeasured
                              ? kFilledByMeasured
                              : kFilledByOthers;
  return {kMoved.Probability(quality),
          filled.Probability(quality),
          kStanding.Probability(quality),
          kStandingWeakly.Probability(quality)};
}

}  // namespace tsar
