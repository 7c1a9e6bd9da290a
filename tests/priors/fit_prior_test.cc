// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/fit_prior.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tests/support/synthetic_observations.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kNoise = 0.002;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Depths between 2 and 8 with errors of 0.2 %, a share of which is wrong by
// factors of up to 3 either way.
std::vector<PriorSample> DrawSamples(
    const std::function<double(double depth)>& value_of,
    double share_of_wrong = 0.2) {
  Philox random(5, 0, 0);
  std::vector<PriorSample> samples;
  for (int i = 0; i < 2000; ++i) {
    const double depth = 2.0 + 6.0 * random.NextFloat();
    const double error = kNoise * NextNormal(&random);
    const bool is_wrong = random.NextFloat() < share_of_wrong;
    const double factor = std::pow(3.0, 2.0 * random.NextFloat() - 1.0);
    samples.push_back(
        {value_of(depth), depth * (1.0 + error) * (is_wrong ? factor : 1.0)});
  }
  return samples;
}

void ExpectFunction(const PriorFit& fit,
                    PriorType type,
                    double scale,
                    double shift) {
  EXPECT_EQ(fit.function.type, type);
  EXPECT_NEAR(fit.function.scale, scale, 0.005 * scale);
  EXPECT_NEAR(fit.function.shift, shift, 0.01 * std::abs(shift));
  // A fifth of wrong ones raises the median of the errors a little.
  EXPECT_GT(fit.spread, kNoise);
  EXPECT_LT(fit.spread, 1.5 * kNoise);
  EXPECT_GT(fit.Skill(), 0.98);
}

double FactorValue(double depth) { return depth / 3.0; }
double RelativeValue(double depth) { return (depth - 1.5) / 3.0; }
double InverseValue(double depth) { return (1.0 / depth - 0.1) / 0.7; }

// With a given type, and with one that is to be found.
TEST(FitPriorTest, FindsTheFunctionAmongWrongSamples) {
  struct Case {
    double (*value_of)(double depth);
    PriorType type;
    double scale;
    double shift;
  };
  for (const auto& [value_of, type, scale, shift] :
       {Case{&FactorValue, PriorType::kMetric, 3.0, 0.0},
        Case{&RelativeValue, PriorType::kRelative, 3.0, 1.5},
        Case{&InverseValue, PriorType::kInverse, 0.7, 0.1}}) {
    const std::vector<PriorSample> samples = DrawSamples(value_of);
    for (const PriorType given : {type, PriorType::kAuto}) {
      ExpectFunction(FitPrior(samples, given), type, scale, shift);
    }
  }
}

TEST(FitPriorTest, NoiseExplainsNothing) {
  Philox random(6, 0, 0);
  const std::vector<PriorSample> samples =
      DrawSamples([&](double) { return 1.0 + 5.0 * random.NextFloat(); }, 0.0);
  for (const PriorType type : {PriorType::kAuto,
                               PriorType::kMetric,
                               PriorType::kRelative,
                               PriorType::kInverse}) {
    EXPECT_LT(FitPrior(samples, type).Skill(), 0.1);
  }
}

// Depth that was declared as inverse depth.
TEST(FitPriorTest, AFallingPriorIsNoneOfItsType) {
  const PriorFit fit = FitPrior(DrawSamples(&InverseValue), PriorType::kMetric);
  EXPECT_EQ(fit.function.type, PriorType::kMetric);
  EXPECT_LT(fit.Skill(), 0.0);
  EXPECT_NEAR(
      FitPrior(DrawSamples(&InverseValue), PriorType::kRelative).Skill(),
      0.0,
      1e-9);
  EXPECT_NEAR(
      FitPrior(DrawSamples(&RelativeValue), PriorType::kInverse).Skill(),
      0.0,
      1e-9);
}

TEST(PriorFunctionTest, HasNoDepthBehindTheCamera) {
  const PriorFunction relative{PriorType::kRelative, 2.0, -3.0};
  EXPECT_DOUBLE_EQ(relative.Depth(4.0), 5.0);
  EXPECT_EQ(relative.Depth(1.5), 0.0);
  EXPECT_EQ(relative.Depth(1.0), 0.0);
  const PriorFunction inverse{PriorType::kInverse, 2.0, -3.0};
  EXPECT_DOUBLE_EQ(inverse.Depth(4.0), 0.2);
  EXPECT_EQ(inverse.Depth(1.5), 0.0);
  for (const double value : {0.0, -1.0, kNan}) {
    EXPECT_EQ((PriorFunction{PriorType::kInverse, 1.0, 1.0}.Depth(value)), 0.0);
  }
  EXPECT_EQ((PriorFunction{PriorType::kRelative, 0.0, 1.0}.Depth(1.0)), 0.0);
}

TEST(RobustSpreadTest, IsTheStandardDeviationOfNormalErrors) {
  Philox random(7, 0, 0);
  std::vector<double> errors;
  for (int i = 0; i < 20000; ++i) {
    errors.push_back(0.3 * NextNormal(&random));
  }
  EXPECT_NEAR(RobustSpread(errors), 0.3, 0.01);
}

}  // namespace
}  // namespace tsar
