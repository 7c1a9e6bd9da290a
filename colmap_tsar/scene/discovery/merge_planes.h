// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/scene/discovery/plane_scores.h"
#include "colmap_tsar/scene/discovery/superpixel_observations.h"
#include "colmap_tsar/scene/evidence/superpixel_matches.h"
#include "colmap_tsar/view/planes/fit_plane.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <vector>

namespace tsar {

// The scale of Cauchy's loss as a share of the tolerance.
inline constexpr double kCauchyShare = 0.5;

// Fits planes to what superpixels of several views observed. Keeps pointers.
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

  // Evenly spaced observations of some superpixels; by default as many as a
  // fit needs.
  FitSamples Sample(const std::vector<int>& members) const;
  FitSamples Sample(const std::vector<int>& members, size_t max_samples) const;

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

// Planes are not merged that are further apart, in tolerances, where each of
// them was measured.
inline constexpr double kMaxMergeDistance = 10.0;

// That many joint fits, of which a pair has two, are scored at a time at most.
inline constexpr int kMaxJointFits = 64;

// Whether their directions are close enough at all.
bool MayBeMerged(const WorldPlane& a, const WorldPlane& b);

// Drops planes and replaces pairs by a joint fit as long as there is a change
// that costs less than it may; the one that costs the smallest share of that
// comes first. Dropping a plane may cost min_gain; what its superpixels lose
// counts by the share of the views that assign what they match to it as well.
// Merging two may cost min_gain or, if that is more, the support of the smaller
// one times the square of its confusion with the larger one, the share of other
// views that assign the matches of its superpixels to that: two views must take
// it for the other. Returns whether there was any change, which does not depend
// on the threads.
bool DropAndMergePlanes(const SuperpixelPlaneFitter& fitter,
                        const SuperpixelMatches& matches,
                        double min_gain,
                        ThreadPool& threads,
                        std::vector<ScoredPlane>* planes);

}  // namespace tsar
