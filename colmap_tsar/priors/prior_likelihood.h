// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

// An aligned prior in one pixel.
struct PriorDepth {
  float depth = 0.f;  // 0: nothing.
  // See AlignedPrior.
  float sigma = 0.f;
  float outlier_share = 0.f;
};

// The log likelihood ratio of the prior for a right against a wrong depth:
// wrong depths are uniform in their logarithms, over a factor of e. 0 where
// there is no prior, or one with errors as wide. It is bounded on both sides,
// by sigma and by the share of outliers.
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

// The probability that a prior's relative error is below `error`, by an
// approximation of the normal distribution that is accurate to 0.01.
TSAR_HD inline float ProbabilityWithin(const PriorDepth& prior, float error) {
  constexpr float kTwoOverPi = 0.63661977f;
  const float share = error / prior.sigma;
  return (1.f - prior.outlier_share) *
         sqrtf(1.f - ExpOfNegative(-kTwoOverPi * share * share));
}

// The probability that a prior lies on the right surface.
TSAR_HD inline float ProbabilityOfSurface(const PriorDepth& prior) {
  return ProbabilityWithin(prior, 0.03f);
}

// The standard deviation, in radians, of the direction of a superpixel's mean
// normal, in each of two directions. sigma: that of normals that agree. mean:
// not unit; normals that do not agree, as across an edge, shorten it, and their
// variance, 2 (1 - |mean|), adds to it.
TSAR_HD inline float NormalSigma(float sigma, const Vec3f& mean) {
  return sqrtf(sigma * sigma + fmaxf(2.f * (1.f - Norm(mean)), 0.f));
}

// Whether the normals of a superpixel with this mean are of one surface: they
// deviate by less than 18 degrees.
TSAR_HD inline bool AreOfOneSurface(const Vec3f& mean) {
  return Norm(mean) > 0.95f;
}

// Updates the probability of a depth by the log likelihood ratio of a prior.
TSAR_HD inline float PosteriorProbability(float probability, float log_ratio) {
  const float odds = probability / (1.f - probability);
  const float ratio = ExpOfNegative(-fabsf(log_ratio));
  return log_ratio > 0.f ? odds / (odds + ratio)
                         : odds * ratio / (odds * ratio + 1.f);
}

}  // namespace tsar
