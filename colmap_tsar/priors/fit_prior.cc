// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/fit_prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// More samples than this only take more time.
constexpr size_t kMaxSamples = 20000;
constexpr int kNumIterations = 30;
// The lower bound of relative errors.
constexpr double kMinError = 1e-3;
// A type with fewer unknowns is preferred to one that is hardly better.
constexpr double kMinImprovement = 0.95;

// The robust standard deviation of the logarithms about their median.
double SpreadOfDepths(const std::vector<PriorSample>& samples) {
  std::vector<double> values;
  for (const PriorSample& sample : samples) {
    values.push_back(std::log(sample.depth));
  }
  const double median = UpperMedian(&values);
  for (double& value : values) {
    value -= median;
  }
  return RobustSpread(std::move(values));
}

std::vector<PriorSample> ThinOut(const std::vector<PriorSample>& samples) {
  const size_t count = std::min(samples.size(), kMaxSamples);
  std::vector<PriorSample> result;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    result.push_back(samples[i * samples.size() / count]);
  }
  return result;
}

PriorFunction FitFactor(const std::vector<PriorSample>& samples) {
  std::vector<double> ratios;
  for (const PriorSample& sample : samples) {
    ratios.push_back(sample.depth / sample.value);
  }
  return {PriorType::kMetric, UpperMedian(&ratios), 0.0};
}

// Fits the line y = scale x + shift to small errors relative to y by
// iteratively reweighted least squares. Scale 0 where there is no rising line.
PriorFunction FitLine(const std::vector<PriorSample>& samples, PriorType type) {
  const bool is_inverse = type == PriorType::kInverse;
  std::vector<double> targets;
  for (const PriorSample& sample : samples) {
    targets.push_back(is_inverse ? 1.0 / sample.depth : sample.depth);
  }
  double scale = 0.0;
  double shift = 0.0;
  for (int iteration = 0; iteration < kNumIterations; ++iteration) {
    double w = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (size_t i = 0; i < samples.size(); ++i) {
      const double value = samples[i].value;
      const double target = targets[i];
      // Its square over the relative error, which is at first 1 for all.
      const double error =
          iteration == 0 ? target : std::abs(scale * value + shift - target);
      const double weight =
          1.0 / (target * std::max(error, kMinError * target));
      w += weight;
      x += weight * value;
      y += weight * target;
      xx += weight * value * value;
      xy += weight * value * target;
    }
    const double determinant = w * xx - x * x;
    if (!(determinant > 1e-12 * w * xx)) {
      return {type, 0.0, 0.0};
    }
    scale = (w * xy - x * y) / determinant;
    shift = (y - scale * x) / w;
  }
  return {type, scale > 0.0 ? scale : 0.0, shift};
}

PriorFit FitType(const std::vector<PriorSample>& samples,
                 PriorType type,
                 double spread_of_depths) {
  const PriorFunction function =
      type == PriorType::kMetric ? FitFactor(samples) : FitLine(samples, type);
  std::vector<double> errors;
  for (const PriorSample& sample : samples) {
    const double depth = function.Depth(sample.value);
    // A value without a depth counts as a very large error.
    errors.push_back(depth > 0.0 ? std::log(sample.depth / depth) : 1e3);
  }
  return {function,
          function.scale > 0.0 ? RobustSpread(errors) : spread_of_depths,
          spread_of_depths};
}

}  // namespace

double PriorFunction::Depth(double value) const {
  if (!(value > 0.0) || !(scale > 0.0)) {
    return 0.0;
  }
  const double result = scale * value + shift;
  if (!(result > 0.0)) {
    return 0.0;
  }
  return type == PriorType::kInverse ? 1.0 / result : result;
}

PriorFit FitPrior(const std::vector<PriorSample>& all_samples, PriorType type) {
  const std::vector<PriorSample> samples = ThinOut(all_samples);
  const double spread_of_depths = SpreadOfDepths(samples);
  if (type != PriorType::kAuto) {
    return FitType(samples, type, spread_of_depths);
  }
  PriorFit best = FitType(samples, PriorType::kMetric, spread_of_depths);
  for (const PriorType other : {PriorType::kRelative, PriorType::kInverse}) {
    const PriorFit fit = FitType(samples, other, spread_of_depths);
    const double allowed = best.function.type == PriorType::kMetric
                               ? kMinImprovement * best.spread
                               : best.spread;
    if (fit.spread < allowed) {
      best = fit;
    }
  }
  return best;
}

}  // namespace tsar
