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

// By superpixel, on which sides of the creases where new planes begin its
// middle lies: equal numbers stand for equal sides of all.
std::vector<int> FindSidesOfCreases(const ObservedView& view,
                                    const std::vector<ModelPlane>& planes,
                                    const std::vector<BoundingCrease>& creases);

// Adds the costs of a view's labels where planes end at creases, of superpixels
// (row) on planes (column): on planes behind one that begins at a crease, which
// hides them, the one that ends there among them, and on one that begins at a
// crease where the superpixel does not lie beyond it. Beyond it that plane has
// no cost for being unknown, and its uncertainty is at most one half. indices:
// of the columns in the model, ascending; creases: of these planes; votes: of
// the size of the costs, or empty.
void AddCreaseVotes(const ObservedView& view,
                    const std::vector<ModelPlane>& planes,
                    const std::vector<int>& indices,
                    const std::vector<BoundingCrease>& creases,
                    const LabelOptions& options,
                    Image<PlaneCost>* costs,
                    Image<float>* votes);

}  // namespace tsar
