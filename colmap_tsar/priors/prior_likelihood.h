// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/exponential.h"
#include "colmap_tsar/base/logarithm.h"
#include "colmap_tsar/base/macros.h"

#include <cmath>

namespace tsar {

// What an aligned prior says of one pixel.
struct PriorDepth {
  float depth = 0.f;  // 0: nothing.
  // See AlignedPrior.
  float sigma = 0.f;
  float outlier_share = 0.f;
};

// The logarithm of how much likelier the prior is where the depth is right than
// where it is wrong: wrong depths are spread over a factor of e, evenly in
// their logarithms. 0 where there is no prior, or one whose errors are spread
// as far. It is bounded on both sides, by sigma and by the share of outliers.
TSAR_HD inline float LogLikelihoodRatio(const PriorDepth& prior, float depth) {
  constexpr float kOneOverRootTwoPi = 0.39894228f;
  if (!(prior.depth > 0.f) || !(depth > 0.f) ||
      prior.sigma >= kOneOverRootTwoPi) {
    return 0.f;
  }
  const float error = NaturalLogarithm(depth / prior.depth) / prior.sigma;
  const float normal =
      kOneOverRootTwoPi / prior.sigma * ExpOfNegative(-0.5f * error * error);
  return NaturalLogarithm((1.f - prior.outlier_share) * normal +
                          prior.outlier_share);
}

// The probability of a depth that had the given one before the prior was asked.
TSAR_HD inline float PosteriorProbability(float probability, float log_ratio) {
  const float odds = probability / (1.f - probability);
  const float ratio = ExpOfNegative(-fabsf(log_ratio));
  return log_ratio > 0.f ? odds / (odds + ratio)
                         : odds * ratio / (odds * ratio + 1.f);
}

}  // namespace tsar
