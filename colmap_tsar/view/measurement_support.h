// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/view/view_votes.h"

#include <cmath>

namespace tsar {

// The evidence for and against a measured depth.
struct MeasurementSupport {
  ViewVotes votes;
  // Standard deviation of the gray levels around the pixel (ComputeTexture).
  float texture = 0.f;
  bool is_trusted = false;  // See MeasurementFlags.
};

// The surface that would replace the measurement: the plane of the pixel's
// superpixel.
struct Rival {
  ViewVotes votes;
  // Difference of the two depths, in relative depths of one pixel of disparity.
  float gap = 0.f;
  float margin = 0.f;  // LabelQuality::margin.
};

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
TSAR_HD inline void ShareVotes(const ViewVotes& votes, float* shares) {
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
  static constexpr int kCount = kNumVoteShares + 3;
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

// The log-odds that the measurement is nearer to the truth than its rival.
TSAR_HD inline float LogOddsAgainst(const Rival& rival,
                                    const MeasurementSupport& support) {
  constexpr float kSupport[] = {0.35f, 0.43f, 0.14f, -2.28f, -2.63f};
  constexpr float kRival[] = {-1.65f, -1.98f, 3.78f, -0.58f, 0.17f, -0.13f};
  return -1.37f + WeighedSum(kSupport, SupportTerms(support).values) +
         WeighedSum(kRival, RivalTerms(rival).values);
}

}  // namespace tsar
