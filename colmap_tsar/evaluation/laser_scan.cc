// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/evaluation/laser_scan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace tsar {
namespace {

constexpr double kCellsPerUnit = 256;

// Beyond this sine of the angle between point and beam, looking at all points
// is cheaper than at all cells.
constexpr double kMaxSineForCells = 0.05;

int CellCoordinate(double value) {
  return static_cast<int>(std::floor((value + 1.0) * kCellsPerUnit));
}

uint64_t CellKey(int x, int y, int z) {
  constexpr int kMargin = 64;  // Keys of cells outside the cube are valid.
  return (static_cast<uint64_t>(x + kMargin) << 40) |
         (static_cast<uint64_t>(y + kMargin) << 20) |
         static_cast<uint64_t>(z + kMargin);
}

uint64_t CellKeyOf(const Eigen::Vector3d& direction) {
  return CellKey(CellCoordinate(direction.x()),
                 CellCoordinate(direction.y()),
                 CellCoordinate(direction.z()));
}

}  // namespace

LaserScan::LaserScan(std::vector<Eigen::Vector3d> points, const LaserBeam& beam)
    : beam_(beam) {
  std::vector<std::pair<uint64_t, size_t>> order(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    order[i] = {CellKeyOf(points[i].normalized()), i};
  }
  std::sort(order.begin(), order.end());
  points_.reserve(points.size());
  directions_.reserve(points.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const auto& [key, index] = order[i];
    points_.push_back(points[index]);
    directions_.push_back(points[index].normalized());
    PointRange& range = cells_.try_emplace(key, PointRange{i, i}).first->second;
    range.end = i + 1;
  }
}

PointVerdict LaserScan::Judge(const Eigen::Vector3d& point,
                              const std::vector<double>& tolerances) const {
  const double range = point.norm();
  const double beam_radius =
      beam_.start_radius +
      range * std::tan(beam_.divergence_degrees * std::numbers::pi / 180.0);
  PointVerdict verdict{static_cast<int>(tolerances.size()), false};

  const auto judge = [&](const PointRange& candidates) {
    for (size_t i = candidates.begin; i < candidates.end; ++i) {
      const double along = directions_[i].dot(point);
      if (along < 0 || (point - along * directions_[i]).squaredNorm() >
                           beam_radius * beam_radius) {
        continue;
      }
      const double distance = (point - points_[i]).norm();
      while (verdict.first_good > 0 &&
             distance <= tolerances[verdict.first_good - 1]) {
        --verdict.first_good;
      }
      verdict.bad_below |= along < directions_[i].dot(points_[i]);
    }
  };

  if (beam_radius >= kMaxSineForCells * range) {
    judge({0, points_.size()});
    return verdict;
  }
  // For small angles the chord is hardly longer than the sine.
  const double chord = 1.001 * beam_radius / range;
  const Eigen::Vector3d direction = point / range;
  int low[3];
  int high[3];
  for (int axis = 0; axis < 3; ++axis) {
    low[axis] = CellCoordinate(direction[axis] - chord);
    high[axis] = CellCoordinate(direction[axis] + chord);
  }
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        const auto cell = cells_.find(CellKey(x, y, z));
        if (cell != cells_.end()) {
          judge(cell->second);
        }
      }
    }
  }
  return verdict;
}

}  // namespace tsar
