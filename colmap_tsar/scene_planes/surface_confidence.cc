// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_confidence.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// The log-odds of a depth being right: a constant, and how much each measure of
// the label counts. The margin of a label contains what it gains by other views
// that have the same label, which are often those that confirm it: beside the
// margin these count against it.
struct LogOdds {
  float constant = 0.f;
  float strength = 0.f;
  float confirmed = 0.f;
  float uncertainty = 0.f;
  float margin = 0.f;

  float Probability(const LabelQuality& quality) const {
    const float log_odds = constant + strength * quality.strength.Value() +
                           confirmed * quality.confirmed.Value() +
                           uncertainty * quality.uncertainty.Value() +
                           margin * quality.margin.Value();
    return std::clamp(1.f / (1.f + std::exp(-log_odds)),
                      kMinConfidence,
                      1.f - kMinConfidence);
  }
};

constexpr LogOdds kMoved = {
    .constant = 0.64f, .confirmed = -0.59f, .margin = 7.18f};
constexpr LogOdds kFilledByMeasured = {.constant = 0.30f,
                                       .confirmed = -2.94f,
                                       .uncertainty = -0.43f,
                                       .margin = 9.88f};
// Planes that other views measured there, or none.
constexpr LogOdds kFilledByOthers = {.constant = -0.24f, .strength = 4.87f};
// Less than they would get by the fit (-0.05, 4.20, 0, 11.85), which rendered
// scenes dominate: of the guesses on photographs much fewer are right.
constexpr LogOdds kGuessed = {.constant = -0.50f,
                              .strength = 3.62f,
                              .uncertainty = -2.46f,
                              .margin = 11.45f};

const LogOdds& Filled(LabelEvidence evidence) {
  switch (evidence) {
    case LabelEvidence::kMeasured:
      return kFilledByMeasured;
    case LabelEvidence::kCarried:
      return kFilledByOthers;
    case LabelEvidence::kNone:
    case LabelEvidence::kGuessed:
    case LabelEvidence::kBounded:
      break;
  }
  return kGuessed;
}

}  // namespace

SurfaceConfidence RateSurface(LabelEvidence evidence,
                              const LabelQuality& quality) {
  return {kMoved.Probability(quality), Filled(evidence).Probability(quality)};
}

}  // namespace tsar
