// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/plane_measurement.h"

#include <vector>

namespace tsar {

struct MeasureViewOptions {
  // How far a depth may be off a plane, in relative depths of one pixel of
  // disparity, and the expected error of one observation as a share of that.
  double tolerance = 1.0;
  double error_share = 0.25;
  // Pixels of full confidence that count as one measurement: neighbouring ones
  // err together.
  double full_weight = 40.0;
  // A superpixel counts for so many of them at most.
  double max_weight = 40.0;
  // The loss turns into a logarithm where that of the fits in DiscoverPlanes
  // does, at half of the tolerance.
  MeasurePlaneOptions planes = {2.0, 0.5};
};

// What a view measured of each plane that any of its superpixels is assigned
// to, in the order of the planes' numbers. assignment: per superpixel the
// number of its plane, or -1.
std::vector<PlaneMeasurement> MeasureView(const ObservedView& view,
                                          const std::vector<int>& assignment,
                                          const std::vector<WorldPlane>& planes,
                                          const MeasureViewOptions& options);

}  // namespace tsar
