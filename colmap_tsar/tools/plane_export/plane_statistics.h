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

// A view's share of a plane.
struct PlaneSighting {
  int image = 0;  // Index into the sparse model's images.
  int64_t num_pixels = 0;
  bool is_on_normal_side = false;  // The camera's center.
};

// What all views show of a plane, before anything is drawn.
struct PlaneStatistics {
  int64_t num_pixels = 0;
  int64_t num_measured = 0;  // Those whose depth was measured there.
  std::vector<PlaneSighting> sightings;  // By image.
  Eigen::AlignedBox2d box;               // Of the pixels' middles.
  // Numbers of pixels by the size of their footprints, in eighths of an octave.
  std::map<int, int64_t> footprints;

  // How long the side of a pixel is on the plane, in the median; 0 where no
  // pixel sees it.
  double MedianFootprint() const;
  // Whether more pixels see it from where its normal points than from behind.
  bool IsSeenFromNormalSide() const;
};

void AddStatistics(const PlaneView& view,
                   const std::vector<PlaneCoordinates>& planes,
                   std::vector<PlaneStatistics>* statistics);

}  // namespace tsar
