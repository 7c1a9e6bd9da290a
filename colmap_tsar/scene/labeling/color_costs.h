// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"

#include <vector>

namespace tsar {

// Adds to the costs of superpixels (row) on planes (column) what the colours of
// the other views say of them: how much worse they fit there than on the plane
// that fits best, over the regions of one colour that the superpixel is in (see
// color_regions.h), in the region that tells most. inputs: with confident
// depths; planes: in the reference camera's frame.
void AddColorCosts(const LabelInputs& inputs,
                   const std::vector<Plane>& planes,
                   const LabelOptions& options,
                   ImageView<PlaneCost> costs,
                   Device& device);

}  // namespace tsar
