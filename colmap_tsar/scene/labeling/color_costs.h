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

// Adds to the costs of superpixels (row) on planes (column) the photometric
// cost in the other views: the color difference beyond that on the best plane,
// for the region of one color around the superpixel (see color_regions.h) with
// the largest difference. inputs: with confident depths; planes: in the
// reference camera's frame.
void AddColorCosts(const LabelInputs& inputs,
                   const std::vector<Plane>& planes,
                   const LabelOptions& options,
                   ImageView<PlaneCost> costs,
                   Device& device);

}  // namespace tsar
