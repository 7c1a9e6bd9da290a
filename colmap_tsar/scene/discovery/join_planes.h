// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

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

// The planes that were discovered in some of a scene's views.
struct PlaneBlock {
  std::vector<MeasuredScenePlane> planes;
  // Other blocks with views of the same surfaces, in ascending order; the
  // relation is symmetric.
  std::vector<int> neighbors;
};

struct JoinedPlanes {
  std::vector<MeasuredScenePlane> planes;  // By decreasing support.
  // indices[block][plane] is the index in `planes` of a block's plane.
  std::vector<std::vector<int>> indices;
};

// Replaces planes of neighboring blocks that are one surface by a joint fit:
// as long as the loss of score is at most min_gain or a tenth of the smaller
// support, in the order of the loss. A joint plane belongs to the blocks of
// both, so that a wall along many blocks becomes one plane. Planes of one block
// are joined only as parts of such a wall.
//
// min_gain: see DiscoverPlanesOptions. device: for its threads; the result does
// not depend on their number. Memory and time grow with the number of blocks,
// as long as each has few neighbors and no plane runs along more than a
// thousand of them, since each plane joined into it is compared with all along
// it.
JoinedPlanes JoinPlanes(std::vector<PlaneBlock> blocks,
                        double min_gain,
                        Device& device);

}  // namespace tsar
