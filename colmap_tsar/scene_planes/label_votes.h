// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/plane_costs.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Adds to the cost of each superpixel of the first view (row) on each plane
// (column) what the labels of the other views say about it. A pixel on a plane
// costs less for each view that has the same plane where it sees that pixel,
// and more for each that has another plane nearby, or one behind it: a surface
// that is within the errors of another one is that one, and what a view sees
// through is not there. Labels count by how firmly they were measured
// (LabelVoteOptions). views: see LabelView; planes: in the reference camera's
// frame. labels: of views[1], views[2], ..., in numbers of these planes.
void AddLabelVotes(const std::vector<ObservedView>& views,
                   const std::vector<Plane>& planes,
                   const std::vector<VotingLabels>& labels,
                   const LabelVoteOptions& options,
                   Device& device,
                   Image<PlaneCost>* costs);

// num_pixels, num_superpixels: of each view.
int64_t AddLabelVotesWorkingBytes(int num_views,
                                  int64_t num_pixels,
                                  int64_t num_superpixels,
                                  int num_planes);

}  // namespace tsar
