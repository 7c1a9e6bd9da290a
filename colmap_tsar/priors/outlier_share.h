// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tsar {

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
