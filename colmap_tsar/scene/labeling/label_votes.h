// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"

#include <cstdint>
#include <vector>

namespace tsar {

// What the labels of the sources add to the cost of each superpixel of the
// reference (row) on each plane (column). A pixel on a plane costs less for
// each view that has the same plane where it sees that pixel, and more for each
// that has another plane nearby, or one behind it: a surface that is within the
// errors of another one is that one, and what a view sees through is not there.
// Labels count by how firmly they were measured (LabelVoteOptions). inputs:
// with superpixels; planes: in the reference camera's frame. labels: of the
// sources, in numbers of these planes.
Image<float> ComputeLabelVotes(const LabelInputs& inputs,
                               const std::vector<Plane>& planes,
                               const std::vector<VotingLabels>& labels,
                               const LabelVoteOptions& options,
                               Device& device);

}  // namespace tsar
