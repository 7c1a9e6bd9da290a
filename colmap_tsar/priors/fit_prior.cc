// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/fit_prior.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

// More samples than this change nothing but the time.
constexpr size_t kMaxSamples = 20000;
constexpr int kNumIterations = 30;
// The lower bound of relative errors.
constexpr double kMinError = 1e-3;
constexpr double kMedianToSigma = 1.4826;
// A type with fewer unknowns is preferred to one that is hardly better.
constexpr double kMinImprovement = 0.95;

// The robust standard deviation about the median.
double SpreadAboutMedian(std::vector<double> values) {
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
  double scale = 0.0;
  double shift = 0.0;
  for (int iteration = 0; iteration < kNumIterations; ++iteration) {
    double w = 0.0;
    double x = 0.0;
    double y = 0.0;
    double xx = 0.0;
    double xy = 0.0;
    for (const PriorSample& sample : samples) {
      const double target = is_inverse ? 1.0 / sample.depth : sample.depth;
      double weight = 1.0 / (target * target);
      if (iteration > 0) {
        const double error =
            std::abs((scale * sample.value + shift) / target - 1.0);
        weight /= std::max(error, kMinError);
      }
      w += weight;
      x += weight * sample.value;
      y += weight * target;
      xx += weight * sample.value * sample.value;
      xy += weight * sample.value * target;
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

PriorFit FitType(const std::vector<PriorSample>& samples, PriorType type) {
  PriorFit fit;
  fit.function =
      type == PriorType::kMetric ? FitFactor(samples) : FitLine(samples, type);
  std::vector<double> depths;
  std::vector<double> errors;
  for (const PriorSample& sample : samples) {
    depths.push_back(std::log(sample.depth));
    const double depth = fit.function.Depth(sample.value);
    // A value without a depth counts as a very large error.
    errors.push_back(depth > 0.0 ? std::log(sample.depth / depth) : 1e3);
  }
  fit.spread_of_depths = SpreadAboutMedian(std::move(depths));
  fit.spread = fit.function.scale > 0.0 ? RobustSpread(std::move(errors))
                                        : fit.spread_of_depths;
  return fit;
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
  if (type != PriorType::kAuto) {
    return FitType(samples, type);
  }
  PriorFit best = FitType(samples, PriorType::kMetric);
  for (const PriorType other : {PriorType::kRelative, PriorType::kInverse}) {
    const PriorFit fit = FitType(samples, other);
    const double allowed = best.function.type == PriorType::kMetric
                               ? kMinImprovement * best.spread
                               : best.spread;
    if (fit.spread < allowed) {
      best = fit;
    }
  }
  return best;
}

double RobustSpread(std::vector<double> values) {
  for (double& value : values) {
    value = std::abs(value);
  }
  return kMedianToSigma * UpperMedian(&values);
}

}  // namespace tsar
