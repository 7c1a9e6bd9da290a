// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A plane with a sample of its measurements, for comparison with others without
// the evidence of all its views. World frame.
struct MeasuredScenePlane {
  ScenePlane found;
  // A sample of the observations of its superpixels, inliers or not. Their
  // expected error is the tolerance of planes, and weights are in pixels of
  // full confidence; their sum is that of all observations.
  std::vector<DepthObservation> observations;
};

// The largest number of samples that a plane keeps.
inline constexpr size_t kMaxPlaneSamples = 300;

// Keeps at most kMaxPlaneSamples, evenly spaced, with the same sum of weights.
void ThinOut(std::vector<DepthObservation>* samples);

// The planes discovered in these views with this tolerance, with their samples.
std::vector<MeasuredScenePlane> MeasureScenePlanes(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    double tolerance);

// The plane of the model, of which AdjustModel determines the errors.
ModelPlane ToModelPlane(const MeasuredScenePlane& measured);

// What was discovered in a block of a scene's views.
struct PlaneBlock {
  std::vector<size_t> views;  // Their indices in the scene.
  std::vector<MeasuredScenePlane> planes;
  // See DiscoveredPlanes.
  std::vector<std::vector<int>> assignment;
  std::optional<Eigen::Matrix3d> frame;
  // Other blocks with views of the same surfaces, in ascending order; the
  // relation is symmetric.
  std::vector<int> neighbors;
  int component = 0;  // Of the views.
};

struct JoinedPlanes {
  std::vector<MeasuredScenePlane> planes;  // By decreasing support.
  // indices[block][plane] is the index in `planes` of a block's plane.
  std::vector<std::vector<int>> indices;
};

// Replaces planes of neighboring blocks that are one surface by a joint fit: in
// the order of their loss of score, as long as it is at most min_gain or a
// tenth of the smaller support. A joint plane belongs to the blocks of both, so
// that a wall along many blocks becomes one plane. Planes of one block are
// joined only as parts of such a wall.
//
// min_gain: see DiscoverPlanesOptions. device: for its threads; the result does
// not depend on their number. Memory and time grow with the number of blocks,
// as long as each has few neighbors and no plane spans more than a thousand of
// them, since each plane joined into it is compared with all the others. The
// samples of the blocks' planes are moved to the joined ones.
JoinedPlanes JoinPlanes(std::vector<PlaneBlock>* blocks,
                        double min_gain,
                        Device& device);

}  // namespace tsar
