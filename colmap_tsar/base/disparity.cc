// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/disparity.h"

#include <algorithm>
#include <numeric>

namespace tsar {
namespace {

// The least baseline as a share of the longest; shorter ones are due to
// rounding.
constexpr double kMinBaselineShare = 1e-3;

}  // namespace

DisparityScale ComputeDisparityScale(const Camera& reference,
                                     const std::vector<Camera>& sources) {
  std::vector<double> baselines;
  for (const Camera& source : sources) {
    baselines.push_back((source.Center() - reference.Center()).norm());
  }
  const double longest = baselines.empty() ? 0.0 : std::ranges::max(baselines);
  std::erase_if(baselines, [&](double baseline) {
    return !(baseline > kMinBaselineShare * longest);
  });
  if (baselines.empty()) {
    return {};
  }
  // The nearest sources contribute most matches; the mean of all baselines
  // would make the tolerances several times too tight.
  std::ranges::sort(baselines);
  baselines.resize(std::min<size_t>(baselines.size(), 4));
  const double baseline =
      std::accumulate(baselines.begin(), baselines.end(), 0.0) /
      baselines.size();
  DisparityScale scale;
  scale.factor =
      static_cast<float>(reference.fx * baseline * kPaperSize /
                         std::max(reference.width, reference.height));
  scale.error_per_depth = static_cast<float>(1.0 / (reference.fx * baseline));
  return scale;
}

}  // namespace tsar
