// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/support_grid.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

constexpr double kMaxCells = 1 << 20;
constexpr double kMaxCellsOfAll = 1 << 26;
constexpr double kPixelsPerCell = 2.0;  // Along a side.

// Pixels that are larger than half a cell count at several of their points, at
// most so many along a side.
constexpr int kMaxSamples = 16;

Eigen::Vector2d NumCells(const Eigen::AlignedBox2d& box, double cell) {
  return ((box.sizes() / cell).array().floor() + 1 + 2 * SupportGrid::kPadding)
      .matrix();
}

double CellFor(const PlaneStatistics& statistics) {
  // What the padding takes, too, must fit.
  double cell = kPixelsPerCell * statistics.MedianFootprint();
  while (NumCells(statistics.box, cell).prod() > kMaxCells) {
    cell *= 1.25;
  }
  return cell;
}

int NumSamples(double extent, double cell) {
  return static_cast<int>(std::clamp(
      std::ceil(2.0 * extent / cell), 1.0, static_cast<double>(kMaxSamples)));
}

}  // namespace

std::vector<SupportGrid> MakeSupportGrids(
    const std::vector<PlaneStatistics>& statistics) {
  std::vector<SupportGrid> grids(statistics.size());
  double num_cells = 0.0;
  for (size_t p = 0; p < grids.size(); ++p) {
    if (statistics[p].num_pixels > 0) {
      grids[p].cell = CellFor(statistics[p]);
      num_cells += NumCells(statistics[p].box, grids[p].cell).prod();
    }
  }
  const double growth = std::sqrt(std::max(1.0, num_cells / kMaxCellsOfAll));
  for (size_t p = 0; p < grids.size(); ++p) {
    if (statistics[p].num_pixels > 0) {
      SupportGrid& grid = grids[p];
      grid.cell *= growth;
      const Eigen::Vector2d size = NumCells(statistics[p].box, grid.cell);
      grid.corner =
          statistics[p].box.min() -
          Eigen::Vector2d::Constant((SupportGrid::kPadding - 0.5) * grid.cell);
      grid.coverage =
          Image<float>(static_cast<int>(size.x()), static_cast<int>(size.y()));
    }
  }
  return grids;
}

void AddCoverage(const PlaneView& view,
                 const std::vector<PlaneCoordinates>& planes,
                 std::vector<SupportGrid>* grids) {
  ForEachPlanePixel(
      view,
      planes,
      [&](int p,
          int x,
          int y,
          const PlaneProjection& projection,
          const PlaneProjection::Hit& hit) {
        SupportGrid& grid = (*grids)[static_cast<size_t>(p)];
        const int num_x = NumSamples(hit.extent.x(), grid.cell);
        const int num_y = NumSamples(hit.extent.y(), grid.cell);
        const auto weight = static_cast<float>(
            hit.area / (grid.cell * grid.cell * num_x * num_y));
        for (int j = 0; j < num_y; ++j) {
          for (int i = 0; i < num_x; ++i) {
            Eigen::Vector2d point;
            if (!projection.Intersect(x + (i + 0.5) / num_x - 0.5,
                                      y + (j + 0.5) / num_y - 0.5,
                                      &point)) {
              continue;
            }
            const Eigen::Vector2d place = (point - grid.corner) / grid.cell;
            // What reaches beyond the padding belongs to pixels along the
            // border.
            if (place.x() >= 1.0 && place.y() >= 1.0 &&
                place.x() < grid.coverage.Width() - 1 &&
                place.y() < grid.coverage.Height() - 1) {
              grid.coverage(static_cast<int>(place.x()),
                            static_cast<int>(place.y())) += weight;
            }
          }
        }
      });
}

}  // namespace tsar
