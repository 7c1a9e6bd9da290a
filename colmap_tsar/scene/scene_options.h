// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/view/refine_options.h"

#include <vector>

namespace tsar {

// Options of the search for the planes of the scene, derived from those of a
// run.
struct SceneOptions {
  DiscoverPlanesOptions discovery;
  LabelOptions labels;
};

// The tolerance of residuals at a plane, in relative depths of one pixel of
// disparity. noise: see ViewEvidence.
double ScenePlaneTolerance(const RefineOptions& options, double noise);

// The median of the views' noise where it is above 0; 0 where it never is.
double MedianNoise(const std::vector<ObservedView>& views);

// views: all views of the scene; the tolerance follows from their noise.
SceneOptions MakeSceneOptions(const RefineOptions& options,
                              const std::vector<ObservedView>& views);

}  // namespace tsar
