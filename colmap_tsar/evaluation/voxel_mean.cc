// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/evaluation/voxel_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tsar {
namespace {

using Voxel = std::array<int64_t, 3>;
using PointInVoxel = std::pair<Voxel, size_t>;

Voxel VoxelOf(const Eigen::Vector3d& point, double shift, double voxel_size) {
  // Further away, doubles are coarser than voxels anyway.
  constexpr double kFurthest = 1e15;
  Voxel voxel;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = static_cast<int64_t>(std::clamp(
        std::floor(point[axis] / voxel_size + shift), -kFurthest, kFurthest));
  }
  return voxel;
}

struct VoxelSums {
  double shares = 0;
  int64_t num_voxels = 0;
};

void AddVoxel(const PointInVoxel* begin,
              const PointInVoxel* end,
              const std::vector<PointVerdict>& verdicts,
              std::vector<VoxelSums>* sums) {
  const int num_tolerances = static_cast<int>(sums->size());
  for (int t = 0; t < num_tolerances; ++t) {
    int64_t num_good = 0;
    int64_t num_bad = 0;
    for (const PointInVoxel* point = begin; point != end; ++point) {
      const PointVerdict& verdict = verdicts[point->second];
      if (verdict.first_good <= t) {
        ++num_good;
      } else if (verdict.bad_below) {
        ++num_bad;
      }
    }
    if (num_good + num_bad > 0) {
      (*sums)[t].shares += static_cast<double>(num_good) / (num_good + num_bad);
      ++(*sums)[t].num_voxels;
    }
  }
}

}  // namespace

std::vector<double> VoxelMeans(const std::vector<Eigen::Vector3d>& points,
                               const std::vector<PointVerdict>& verdicts,
                               int num_tolerances,
                               double voxel_size) {
  std::vector<VoxelSums> sums(num_tolerances);
  std::vector<PointInVoxel> sorted(points.size());
  for (const double shift : {0.0, 0.5}) {
    for (size_t i = 0; i < points.size(); ++i) {
      sorted[i] = {VoxelOf(points[i], shift, voxel_size), i};
    }
    std::sort(sorted.begin(), sorted.end());
    const PointInVoxel* const end = sorted.data() + sorted.size();
    for (const PointInVoxel* begin = sorted.data(); begin != end;) {
      const PointInVoxel* next =
          std::find_if(begin, end, [&](const PointInVoxel& point) {
            return point.first != begin->first;
          });
      AddVoxel(begin, next, verdicts, &sums);
      begin = next;
    }
  }
  std::vector<double> means;
  means.reserve(sums.size());
  for (const VoxelSums& sum : sums) {
    means.push_back(sum.num_voxels > 0 ? sum.shares / sum.num_voxels : 0);
  }
  return means;
}

}  // namespace tsar
