// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"

#include <vector>

namespace tsar {

// Labels each superpixel of a view with one of the planes or none, so as to
// minimize the sum of the costs of
// - observations that are outliers of their plane;
// - planes that are not known well enough there, or were not observed around;
// - planes other than those that other views were labeled with;
// - neighbors with different planes, in proportion to the gap between these
//   along the border, unless an edge of the image runs there: where two planes
//   intersect the change is free.
// planes: in the view's frame; costs: see ComputePlaneCosts; votes: see
// ComputeLabelVotes, empty where other views have not been labeled.
ViewLabels ChooseLabels(const ObservedView& view,
                        const std::vector<Plane>& planes,
                        const Image<PlaneCost>& costs,
                        const Image<float>& votes,
                        const LabelOptions& options);

}  // namespace tsar
