// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_statistics.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// How much views cover of a plane, in square cells of its coordinates. The
// outermost cells are empty.
struct SupportGrid {
  static constexpr int kPadding = 4;

  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  // Of the first cell.
  double cell = 0.0;                                 // The length of its side.
  // 1 for each view that sees all of a cell. Empty where nothing is seen.
  Image<float> coverage;

  Eigen::Vector2d Middle(int x, int y) const {
    return corner + cell * Eigen::Vector2d(x + 0.5, y + 0.5);
  }
};

// Grids without coverage, whose cells measure two pixels in the median. Larger
// ones where there would be too many: at most 1 million each, and 64 million
// altogether.
std::vector<SupportGrid> MakeSupportGrids(
    const std::vector<PlaneStatistics>& statistics);

void AddCoverage(const PlaneView& view,
                 const std::vector<PlaneCoordinates>& planes,
                 std::vector<SupportGrid>* grids);

// Which cells belong to the support of a plane: 255, the others 0. Those that
// views cover at least half as much as their neighbors, and a tenth as much as
// the median; without gaps, holes and islands of a few cells, and without what
// lies beyond creases on whose other side nearly all of it lies. Cells that
// touch in a corner alone do not occur.
Image<uint8_t> FindSupport(const SupportGrid& grid,
                           const std::vector<CreaseLine>& creases);

}  // namespace tsar
