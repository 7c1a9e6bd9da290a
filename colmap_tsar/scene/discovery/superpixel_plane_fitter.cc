// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/superpixel_plane_fitter.h"

#include "colmap_tsar/view/planes/depth_observation.h"

#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// The number of observations of a fit, where there are more.
constexpr size_t kMaxFittedObservations = 8000;

}  // namespace

double SuperpixelPlaneFitter::LossScale() const {
  return kCauchyShare * tolerance_;
}

FitSamples SuperpixelPlaneFitter::Sample(
    const std::vector<int>& members) const {
  FitSamples samples;
  observations_->Sample(
      members, kMaxFittedObservations, [&](const DepthObservation& sample) {
        samples.Add(sample);
      });
  return samples;
}

WorldPlane SuperpixelPlaneFitter::Fit(const WorldPlane& initial,
                                      const FitSamples& samples) const {
  return FitPlane(initial, samples, LossScale());
}

ScoredPlane SuperpixelPlaneFitter::ScoreOne(const WorldPlane& plane) const {
  return std::move(Score({plane})[0]);
}

}  // namespace tsar
