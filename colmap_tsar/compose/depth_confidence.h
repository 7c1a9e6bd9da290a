// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/compose/occlusion_votes.h"
#include "colmap_tsar/scene/evidence/label_view.h"

#include <cmath>
#include <cstdint>

namespace tsar {

// The evidence for and against a measured depth.
struct MeasurementSupport {
  OcclusionVotes votes;
  // Standard deviation of the gray levels around the pixel (ComputeTexture).
  float texture = 0.f;
  bool is_trusted = false;  // See MeasurementFlags.
};

// The surface that would replace the measurement: the plane of the pixel's
// superpixel.
struct Rival {
  OcclusionVotes votes;
  // Difference of the two depths, in relative depths of one pixel of disparity.
  float gap = 0.f;
  float margin = 0.f;  // LabelQuality::margin.
  // How much worse the colors of other views fit it than the measurement, from
  // -1 to 1. Matching windows show less of thin objects than of the plane
  // behind them.
  float misfit = 0.f;
};

// See Rival::misfit; 0 where fewer than two views see both.
TSAR_HD inline float MisfitOf(const OcclusionVotes& rival,
                              const OcclusionVotes& measured) {
  if (rival.second_color == OcclusionVotes::kNoColor ||
      measured.second_color == OcclusionVotes::kNoColor) {
    return 0.f;
  }
  return static_cast<float>(rival.color + rival.second_color - measured.color -
                            measured.second_color) /
         (2.f * (OcclusionVotes::kNoColor - 1));
}

// Difference of two depths of one ray, in relative depths of one pixel of
// disparity.
TSAR_HD inline float GapInPixels(float own,
                                 float other,
                                 const DepthResolution& resolution) {
  return fabsf(other - own) / (own * resolution.RelativeDepthError(own));
}

inline constexpr int kNumVoteShares = 3;
// Writes the shares of the votes that agree, of those for a surface in front,
// and of those for one behind, each as a share of all votes plus one.
TSAR_HD inline void ShareVotes(const OcclusionVotes& votes, float* shares) {
  const float share = 1.f / static_cast<float>(1 + votes.Count());
  shares[0] = share * static_cast<float>(votes.agreeing);
  shares[1] = share * static_cast<float>(votes.in_front);
  shares[2] = share * static_cast<float>(votes.behind);
}

// The terms of the regressions below, in their order (docs/method.md,
// "Measurement or plane"; benchmarks/fit_measurements.cc finds the weights).
struct SupportTerms {
  static constexpr int kCount = 2 + kNumVoteShares;
  float values[kCount];

  TSAR_HD explicit SupportTerms(const MeasurementSupport& support) {
    values[0] = NaturalLogarithm(1.f + support.texture * support.texture);
    values[1] = support.is_trusted ? 1.f : 0.f;
    ShareVotes(support.votes, values + 2);
  }
};
struct RivalTerms {
  static constexpr int kCount = kNumVoteShares + 4;
  float values[kCount];

  TSAR_HD explicit RivalTerms(const Rival& rival) {
    constexpr float kMinGap = 1e-3f;
    constexpr float kMaxGap = 100.f;
    const float log_gap =
        NaturalLogarithm(fminf(fmaxf(rival.gap, kMinGap), kMaxGap));
    ShareVotes(rival.votes, values);
    float* rest = values + kNumVoteShares;
    rest[0] = log_gap;
    rest[1] = log_gap * log_gap;
    rest[2] = rival.margin;
    rest[3] = rival.misfit;
  }
};

template <int kCount>
TSAR_HD inline float WeighedSum(const float (&weights)[kCount],
                                const float (&values)[kCount]) {
  float sum = 0.f;
  for (int i = 0; i < kCount; ++i) {
    sum += weights[i] * values[i];
  }
  return sum;
}

// The log-odds that the measurement is closer to the true depth than its rival.
TSAR_HD inline float LogOddsAgainst(const Rival& rival,
                                    const MeasurementSupport& support) {
  constexpr float kSupport[] = {0.31f, 0.34f, 0.58f, -2.25f, -1.63f};
  constexpr float kRival[] = {
      -1.40f, -1.91f, 3.40f, -0.45f, 0.09f, -1.20f, 2.48f};
  return -1.49f + WeighedSum(kSupport, SupportTerms(support).values) +
         WeighedSum(kRival, RivalTerms(rival).values);
}

// The least confidence of a valid depth; 0 stands for no depth.
inline constexpr float kMinConfidence = 0.01f;

TSAR_HD inline float BoundedConfidence(float probability) {
  return fminf(fmaxf(probability, kMinConfidence), 1.f - kMinConfidence);
}

// The origin of a depth of a composed map.
enum class DepthKind : uint8_t {
  kStanding,  // Measured; off its plane or without one.
  kMoved,     // Measured on its plane.
  kFilled,    // Filled by a plane that the view measured around it.
  kCarried,   // Filled by a plane that other views measured there.
  kGuessed,   // Filled by a plane that no view measured there.
  kInterpolated,
};
inline constexpr int kNumDepthKinds = 6;

// LabelQuality of the superpixel of a depth as numbers.
struct LabelMeasures {
  float strength = 0.f;
  float confirmed = 0.f;
  float uncertainty = 0.f;
  float margin = 0.f;
};

// The evidence for a depth of a composed map.
struct DepthEvidence {
  DepthKind kind;
  // Only the votes are used unless kind is kStanding.
  MeasurementSupport support;
  LabelMeasures label;  // Used for depths on planes.
  // The relative depth of one pixel of disparity there, and the view's noise
  // (ViewEvidence) in units of it.
  float resolution = 0.f;
  float noise = 0.f;
};

// The terms of the logistic regression: a constant for each kind, the precision
// of depths there, the votes on measurements and on other depths, and the terms
// of some kinds alone (docs/method.md, "Confidence";
// benchmarks/fit_confidence.cc finds the weights).
struct ConfidenceTerms {
  static constexpr int kCount =
      kNumDepthKinds + 2 + SupportTerms::kCount + kNumVoteShares + 4;
  float values[kCount] = {};

  TSAR_HD explicit ConfidenceTerms(const DepthEvidence& depth) {
    values[static_cast<int>(depth.kind)] = 1.f;
    constexpr float kLeast = 1e-4f;
    float* rest = values + kNumDepthKinds;
    *rest++ = NaturalLogarithm(fmaxf(depth.resolution, kLeast));
    *rest++ = NaturalLogarithm(fmaxf(depth.noise, kLeast));
    if (depth.kind == DepthKind::kStanding) {
      const SupportTerms support(depth.support);
      for (int i = 0; i < SupportTerms::kCount; ++i) {
        rest[i] = support.values[i];
      }
      return;
    }
    rest += SupportTerms::kCount;
    ShareVotes(depth.support.votes, rest);
    rest += kNumVoteShares;
    if (depth.kind <= DepthKind::kGuessed) {
      rest[0] = depth.label.strength;
      rest[1] = depth.label.confirmed;
      rest[2] = depth.label.uncertainty;
      rest[3] = depth.label.margin;
    }
  }
};

// The probability that a depth is right to 1 %, in [kMinConfidence, 1 -
// kMinConfidence].
TSAR_HD inline float ConfidenceOf(const DepthEvidence& depth) {
  constexpr float kWeights[ConfidenceTerms::kCount] = {
      -10.11f, -8.00f, -7.67f, -7.70f, -7.70f, -9.83f, -0.68f,
      -2.65f,  0.17f,  0.67f,  1.49f,  -2.23f, -2.10f, 2.48f,
      0.76f,   -1.18f, -0.89f, -1.40f, -3.19f, 2.66f};
  const float log_odds = WeighedSum(kWeights, ConfidenceTerms(depth).values);
  const float odds = ExpOfNegative(-fabsf(log_odds));
  return BoundedConfidence((log_odds > 0.f ? 1.f : odds) / (1.f + odds));
}

// The probability that a depth lies on the right surface, whatever its
// precision: its confidence if all depths had a typical precision.
TSAR_HD inline float ConfidenceInSurface(DepthEvidence depth) {
  depth.resolution = 0.003f;
  depth.noise = 0.2f;
  return ConfidenceOf(depth);
}

}  // namespace tsar
