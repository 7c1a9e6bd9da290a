// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/depth_observation.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <vector>

namespace tsar {

// A plane with a sample of what was measured of it, so that it can be compared
// with others without the evidence of all its views. World frame.
struct MeasuredScenePlane {
  ScenePlane found;
  // Of the observations of its superpixels, whether they lie on it or not.
  // Their expected error is the tolerance about planes, and the weights are in
  // pixels of full confidence; together they weigh what all observations do.
  std::vector<DepthObservation> observations;
  // One for each superpixel that measured it, with errors that are independent
  // of each other; together they weigh what all of these do.
  std::vector<DepthObservation> superpixels;
};

// No plane keeps more of either.
inline constexpr size_t kMaxPlaneSamples = 300;

// Leaves at most kMaxPlaneSamples, evenly spaced, which together weigh as much.
void ThinOut(std::vector<DepthObservation>* samples);

// Of the planes that were discovered in these views with these options.
std::vector<MeasuredScenePlane> MeasureScenePlanes(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    const DiscoverPlanesOptions& discovery,
    const PlaneSupportOptions& support);

// Without its component and frame.
ModelPlane ToModelPlane(const MeasuredScenePlane& measured);

// The planes that were discovered in some of a scene's views.
struct PlaneBlock {
  std::vector<MeasuredScenePlane> planes;
  // Other blocks of which some view looks at what a view of this one does, in
  // ascending order; each is a neighbour of its neighbours.
  std::vector<int> neighbours;
};

struct JoinedPlanes {
  std::vector<MeasuredScenePlane> planes;  // By falling support.
  // places[block][plane]: which of them a block's plane has become.
  std::vector<std::vector<int>> places;
};

// Replaces planes of neighbouring blocks that are one surface by a joint fit:
// as long as that costs at most min_gain or a tenth of the smaller support,
// the cheapest first. A joint plane belongs to the blocks of both, so that a
// wall along many blocks becomes one. Planes of one block are joined only as
// parts of such a wall.
//
// min_gain: see DiscoverPlanesOptions. device: for its threads; the result does
// not depend on their number. Memory grows with the number of blocks, and time
// about so, as long as each has few neighbours and no plane runs along more
// than a thousand of them: whatever is joined into it is compared with all that
// lies along it.
JoinedPlanes JoinPlanes(std::vector<PlaneBlock> blocks,
                        double min_gain,
                        Device& device);

}  // namespace tsar
