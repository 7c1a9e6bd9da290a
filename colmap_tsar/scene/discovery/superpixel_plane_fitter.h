// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/plane_scores.h"
#include "colmap_tsar/scene/discovery/superpixel_observations.h"
#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

namespace tsar {

// The scale of Cauchy's loss as a share of the tolerance.
inline constexpr double kCauchyShare = 0.5;

// Fits planes to observations of superpixels of several views. Keeps pointers.
class SuperpixelPlaneFitter {
 public:
  // tolerance: see DiscoverPlanesOptions; device: the scorer's.
  SuperpixelPlaneFitter(const SuperpixelObservations& observations,
                        const PlaneScorer& scorer,
                        double tolerance,
                        Device& device)
      : observations_(&observations),
        scorer_(&scorer),
        tolerance_(tolerance),
        device_(&device) {}

  const SuperpixelObservations& Observations() const { return *observations_; }
  double Tolerance() const { return tolerance_; }
  // See FitPlane.
  double LossScale() const;

  // As many of the observations of some superpixels as a fit needs.
  FitSamples Sample(const std::vector<int>& members) const;

  WorldPlane Fit(const WorldPlane& initial, const FitSamples& samples) const;

  std::vector<ScoredPlane> Score(const std::vector<WorldPlane>& planes) const {
    return ScorePlanes(*scorer_, planes, *device_);
  }
  ScoredPlane ScoreOne(const WorldPlane& plane) const;

 private:
  const SuperpixelObservations* observations_;
  const PlaneScorer* scorer_;
  double tolerance_;
  Device* device_;
};

}  // namespace tsar
