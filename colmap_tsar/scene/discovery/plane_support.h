// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cmath>
#include <vector>

namespace tsar {

// A position on a plane, along the axes of its PlaneFrame.
struct PlanePoint {
  float s = 0.f;
  float t = 0.f;
};

// Coordinates on a plane, and its variances. All in the reference camera's
// frame.
struct PlaneFrame {
  Vec3f center;
  Vec3f axis_s;
  Vec3f axis_t;
  // Variance of the plane's height at the center, and per squared distance
  // along each axis; very large where undetermined.
  float height_variance = 0.f;
  float slope_variance_s = 0.f;
  float slope_variance_t = 0.f;

  TSAR_HD PlanePoint Coordinates(const Vec3f& point) const {
    const Vec3f offset = point - center;
    return {Dot(offset, axis_s), Dot(offset, axis_t)};
  }

  // Expected error of the plane's height at a point on it.
  TSAR_HD float Sigma(const PlanePoint& point) const {
    return sqrtf(height_variance + slope_variance_s * point.s * point.s +
                 slope_variance_t * point.t * point.t);
  }
};

struct PlaneSupportOptions {
  // The tolerance of inliers, as in DiscoverPlanesOptions.
  double tolerance = 1.0;
  // Observations of less confidence affect only the extent, not the variances.
  float min_measured_confidence = 0.5f;
  // The expected error of one observation, as a share of the tolerance.
  double error_share = 0.25;
  // Pixels of full confidence that make a superpixel one whole measurement.
  double full_weight = 40.0;
  // Cells along the longer side of the area in which a plane was observed.
  int num_cells = 64;
};

// The variances of the scene's planes, and where all views together observed
// them.
struct PlaneSupport {
  std::vector<PlaneFrame> frames;  // One for each plane.
  // The centers of the cells in which plane k was observed are
  // cells[first_cell[k]] to cells[first_cell[k + 1]].
  std::vector<int> first_cell;
  std::vector<PlanePoint> cells;
  // The side of a cell of each plane.
  std::vector<float> cell_sizes;
};

// The measurements of each plane in all views, in the world frame: one
// observation, with an independent error, for each superpixel assigned to it.
std::vector<std::vector<DepthObservation>> MeasuredSuperpixels(
    const std::vector<ObservedView>& views,
    const DiscoveredPlanes& discovered,
    const PlaneSupportOptions& options);

// views: the first is the reference.
PlaneSupport FindPlaneSupport(const std::vector<ObservedView>& views,
                              const DiscoveredPlanes& discovered,
                              const PlaneSupportOptions& options);

}  // namespace tsar
