// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"

#include <vector>

namespace tsar {

// Adds the costs of a view's labels where planes end at creases, of superpixels
// (row) on planes (column). Superpixels beyond a crease pay on the plane that
// ends there, and on others without evidence, except those that begin at
// another crease in front of the plane that begins here. On planes that begin
// here, the costs for missing measurements are removed, and other superpixels
// are excluded. indices: of the columns in the model, ascending; creases: of
// these planes; votes: of the size of the costs, or empty.
void AddCreaseVotes(const ObservedView& view,
                    const std::vector<ModelPlane>& planes,
                    const std::vector<int>& indices,
                    const std::vector<BoundingCrease>& creases,
                    const Image<PlaneCost>& costs,
                    const LabelOptions& options,
                    Image<float>* votes);

}  // namespace tsar
