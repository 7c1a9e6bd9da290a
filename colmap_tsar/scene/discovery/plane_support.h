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

// views: the first is the reference. tolerance: of
// inliers, as in DiscoverPlanesOptions. num_cells: along the
// longer side of the area in which a plane was observed.
PlaneSupport FindPlaneSupport(const std::vector<ObservedView>& views,
                              const DiscoveredPlanes& discovered,
                              double tolerance,
                              int num_cells = 64);

}  // namespace tsar
