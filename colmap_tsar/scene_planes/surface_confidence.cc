// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_confidence.h"

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
    return 1.f / (1.f + std::exp(-log_odds));
  }
};

constexpr LogOdds kMoved = {.constant = 1.05f,
                            .confirmed = -1.06f,
                            .uncertainty = -3.66f,
                            .margin = 4.98f};
constexpr LogOdds kFilledByMeasured = {.constant = 0.31f,
                                       .confirmed = -3.74f,
                                       .uncertainty = -5.12f,
                                       .margin = 8.79f};
// Planes that the view itself did not measure there.
constexpr LogOdds kFilledByOthers = {.constant = -0.52f,
                                     .strength = 3.21f,
                                     .confirmed = -7.20f,
                                     .uncertainty = -2.20f,
                                     .margin = 11.22f};
constexpr LogOdds kStanding = {
    .constant = 0.16f, .explained = 0.23f, .margin = 0.56f};
constexpr LogOdds kStandingWeakly = {
    .constant = -0.48f, .explained = -2.79f, .margin = 1.69f};

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
