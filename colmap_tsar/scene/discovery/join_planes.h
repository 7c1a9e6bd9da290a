// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/discovery/measured_scene_planes.h"

#include <vector>

namespace tsar {

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
// not depend on their number. Memory grows with the number of blocks, and time
// about so, as long as each has few neighbors and no plane runs along more than
// a thousand of them: every plane joined into it is compared with all planes
// along it.
JoinedPlanes JoinPlanes(std::vector<PlaneBlock> blocks,
                        double min_gain,
                        Device& device);

}  // namespace tsar
