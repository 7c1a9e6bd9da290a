// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tsar {

// A value of a depth prior, and the depth that was measured in its pixel.
struct PriorSample {
  double value = 0.0;
  double depth = 0.0;
};

// A function from the values of a prior to depths.
struct PriorFunction {
  PriorType type = PriorType::kMetric;  // Never kAuto.
  double scale = 1.0;                   // Positive.
  double shift = 0.0;                   // 0 for kMetric.

  // 0 where the value represents no depth in front of the camera.
  double Depth(double value) const;
};

struct PriorFit {
  PriorFunction function;
  // Robust standard deviation of log(measured depth / depth of the prior).
  double spread = 0.0;
  // The baseline: the standard deviation for the best constant depth.
  double spread_of_depths = 0.0;

  // The share of spread_of_depths that the prior explains: 1 for a perfect
  // prior, 0 for one that is no better than a constant.
  double Skill() const {
    return spread_of_depths > 0.0 ? 1.0 - spread / spread_of_depths : 0.0;
  }
};

// Fits the function of the type, or with kAuto of the type with the smallest
// standard deviation, by least absolute relative errors of depth, which are
// robust to wrong measurements. samples: at least one.
PriorFit FitPrior(const std::vector<PriorSample>& samples, PriorType type);

// 1.48 times the median of absolute values: for normal errors about 0 their
// standard deviation. values: at least one.
template <typename T>
double RobustSpread(std::vector<T> values) {
  for (T& value : values) {
    value = std::abs(value);
  }
  return 1.4826 * UpperMedian(&values);
}

// The share of the errors beyond three standard deviations; 0 without errors.
inline float ShareOfOutliers(const std::vector<float>& errors, float sigma) {
  constexpr float kOutlier = 3.f;
  const auto count =
      std::count_if(errors.begin(), errors.end(), [&](float error) {
        return std::abs(error) > kOutlier * sigma;
      });
  return static_cast<float>(count) /
         static_cast<float>(std::max<size_t>(errors.size(), 1));
}

// The bounds of that share in the error model of a prior.
inline constexpr float kMinOutlierShare = 0.02f;
inline constexpr float kMaxOutlierShare = 0.5f;

inline float BoundedOutlierShare(float share) {
  return std::clamp(share, kMinOutlierShare, kMaxOutlierShare);
}

}  // namespace tsar
