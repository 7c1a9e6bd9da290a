// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"

#include <vector>

namespace tsar {

// The change of the cost of each superpixel of the reference (row) on each
// plane (column) by votes of the sources' labels. A pixel on a plane costs less
// for each view with the same label at its projection, and more for each with
// another plane nearby, or one behind it: surfaces within each other's errors
// are the same, and views do not see through surfaces. Votes are weighted by
// the strengths of labels. inputs: with superpixels; planes: in the reference
// camera's frame. labels: of the sources, as indices of these planes.
Image<float> ComputeLabelVotes(const LabelInputs& inputs,
                               const std::vector<Plane>& planes,
                               const std::vector<ViewLabels>& labels,
                               Device& device);

}  // namespace tsar
