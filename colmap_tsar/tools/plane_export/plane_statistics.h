// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/plane_polygon.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"

#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Geometry>

namespace tsar {

// The part of a plane that a view sees.
struct PlaneSighting {
  int image = 0;  // Index into the sparse model's images.
  int64_t num_pixels = 0;
  bool is_on_normal_side = false;  // Of the camera center.
};

// The statistics of a plane over all views.
struct PlaneStatistics {
  int64_t num_pixels = 0;
  int64_t num_measured = 0;              // Pixels with measured depth.
  std::vector<PlaneSighting> sightings;  // By image.
  Eigen::AlignedBox2d box;               // Bounds of the pixel centers.
  // Numbers of pixels by the size of their footprints, in eighths of an octave.
  std::map<int, int64_t> footprints;

  // The median side length of a pixel's footprint; 0 if no pixel sees the
  // plane.
  double MedianFootprint() const;
  // Whether more pixels see the plane from its normal's side than from behind.
  bool IsSeenFromNormalSide() const;
};

void AddStatistics(const PlaneView& view,
                   const std::vector<PlaneCoordinates>& planes,
                   std::vector<PlaneStatistics>* statistics);

}  // namespace tsar
