// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_likelihood.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr PriorDepth kPrior = {
    .depth = 4.f, .sigma = 0.02f, .outlier_share = 0.1f};

TEST(LogLikelihoodRatioTest, IsThatOfNormalErrorsAndOutliers) {
  const auto expected = [](float sigmas) {
    const double normal =
        std::exp(-0.5 * sigmas * sigmas) / (0.02 * std::sqrt(2.0 * M_PI));
    return std::log(0.9 * normal + 0.1);
  };
  for (const float sigmas : {-2.f, 0.f, 0.5f, 1.f, 2.f, 3.f}) {
    EXPECT_NEAR(LogLikelihoodRatio(kPrior, 4.f * std::exp(0.02f * sigmas)),
                expected(sigmas),
                1e-3)
        << sigmas;
  }
}

TEST(LogLikelihoodRatioTest, IsBoundedBySigmaAndTheShareOfOutliers) {
  for (const float depth : {1e-30f, 1e-3f, 1.f, 100.f, 1e30f}) {
    EXPECT_NEAR(LogLikelihoodRatio(kPrior, depth), std::log(0.1f), 1e-4f)
        << depth;
  }
  const float most = LogLikelihoodRatio(kPrior, 4.f);
  PriorDepth worse = kPrior;
  worse.sigma = 0.1f;
  EXPECT_LT(LogLikelihoodRatio(worse, 4.f), most);
  worse = kPrior;
  worse.outlier_share = 0.5f;
  EXPECT_LT(LogLikelihoodRatio(worse, 4.f), most);
  EXPECT_GT(LogLikelihoodRatio(worse, 8.f), LogLikelihoodRatio(kPrior, 8.f));
}

// Even where it is right, it would be less likely than if it were wrong.
TEST(LogLikelihoodRatioTest, SaysNothingWhereItIsSpreadAsFarAsWrongDepths) {
  PriorDepth uncertain = kPrior;
  for (const float sigma : {0.4f, 1.f, 100.f}) {
    uncertain.sigma = sigma;
    EXPECT_EQ(LogLikelihoodRatio(uncertain, 4.f), 0.f);
    EXPECT_EQ(LogLikelihoodRatio(uncertain, 40.f), 0.f);
  }
  uncertain.sigma = 0.35f;
  EXPECT_GT(LogLikelihoodRatio(uncertain, 4.f), 0.f);
  EXPECT_LT(LogLikelihoodRatio(uncertain, 40.f), 0.f);
}

TEST(PosteriorProbabilityTest, AddsLogOdds) {
  for (const float probability : {0.01f, 0.3f, 0.5f, 0.99f}) {
    for (const float log_ratio : {-4.f, -0.5f, 0.f, 0.5f, 4.f}) {
      const double odds =
          probability / (1.0 - probability) * std::exp(log_ratio);
      EXPECT_NEAR(PosteriorProbability(probability, log_ratio),
                  odds / (1.0 + odds),
                  1e-4)
          << probability << ", " << log_ratio;
    }
  }
}

TEST(ProbabilityOfSurfaceTest, IsThatOfAnErrorOfUpToThreePercent) {
  EXPECT_NEAR(ProbabilityOfSurface({2.f, 0.03f, 0.f}), 0.683f, 0.01f);
  EXPECT_NEAR(ProbabilityOfSurface({2.f, 0.03f, 0.5f}), 0.341f, 0.01f);
  EXPECT_NEAR(ProbabilityOfSurface({2.f, 0.001f, 0.f}), 1.f, 0.01f);
}

}  // namespace
}  // namespace tsar
