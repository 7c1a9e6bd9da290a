// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/depth_observation.h"

#include <cstddef>
#include <vector>

namespace tsar {

// A plane with a sample of its measurements, for comparison with others without
// the evidence of all its views. World frame.
struct MeasuredScenePlane {
  ScenePlane found;
  // A sample of the observations of its superpixels, inliers or not. Their
  // expected error is the tolerance of planes, and weights are in pixels of
  // full confidence; their sum is that of all observations.
  std::vector<DepthObservation> observations;
  // A sample with one observation for each superpixel that measured it, with
  // independent errors; the sum of weights is that of all of these.
  std::vector<DepthObservation> superpixels;
};

// The largest number of samples of either kind that a plane keeps.
inline constexpr size_t kMaxPlaneSamples = 300;

// Keeps at most kMaxPlaneSamples, evenly spaced, with the same sum of weights.
void ThinOut(std::vector<DepthObservation>* samples);

// The planes discovered in these views with these options, with their samples.
std::vector<MeasuredScenePlane> MeasureScenePlanes(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    const DiscoverPlanesOptions& discovery,
    const PlaneSupportOptions& support);

// The plane of the model without its component and frame.
ModelPlane ToModelPlane(const MeasuredScenePlane& measured);

}  // namespace tsar
