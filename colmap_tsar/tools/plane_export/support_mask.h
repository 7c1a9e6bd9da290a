// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The coverage of a plane by views, in square cells; the outermost are empty.
struct SupportGrid {
  static constexpr int kPadding = 4;

  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  // Of cell (0, 0).
  double cell = 0.0;                                 // Side length.
  // 1 for each view that sees a full cell. Empty if the plane is not visible.
  Image<float> coverage;

  Eigen::Vector2d Middle(int x, int y) const {
    return corner + cell * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
};

// Makes grids without coverage, whose cells are two median pixels wide, or
// wider to keep to at most 1 million cells each and 64 million altogether.
std::vector<SupportGrid> MakeSupportGrids(
    const std::vector<PlaneStatistics>& statistics);

void AddCoverage(const PlaneView& view,
                 const std::vector<PlaneCoordinates>& planes,
                 std::vector<SupportGrid>* grids);

// The support of a plane: 255 in its cells, 0 in the others. Cells of the
// support have at least half the coverage of their neighbors and a tenth of the
// median. Gaps, holes and islands of a few cells are removed, and cells beyond
// creases on whose other side nearly all of it lies. No two touch in a corner
// only.
Image<uint8_t> FindSupport(const SupportGrid& grid,
                           const std::vector<CreaseLine>& creases);

}  // namespace tsar
