// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/depth_observation.h"
#include "colmap_tsar/planes/world_plane.h"

#include <vector>

namespace tsar {

struct RefinePlaneOptions {
  // Where Cauchy's loss turns from squares to logarithms, in expected errors of
  // the depth.
  double loss_scale = 0.5;
  int max_iterations = 20;
};

// The plane that fits the depths of all views best, searched from the initial
// one: the weighted sum of Cauchy's loss of each depth's distance from the
// plane along its ray, in its expected errors, is at a minimum. Observations
// off the plane are told by that loss alone, so the initial plane has to be
// nearer to the wanted plane than to others.
//
// Returns the initial plane where fewer than ten observations have a weight,
// where they lie on a line, or where the search fails. Works on one thread, and
// the result depends on nothing but the arguments.
WorldPlane RefinePlane(const WorldPlane& initial,
                       const std::vector<DepthObservation>& observations,
                       const RefinePlaneOptions& options);

}  // namespace tsar
