// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <vector>

#include <Eigen/Core>

namespace tsar {

// How one point fares at a list of rising tolerances: good from the tolerance
// with index first_good on, and below that either bad or not counted at all.
struct PointVerdict {
  int first_good = 0;
  bool bad_below = true;
};

// The share of good among the counted points at each tolerance, averaged over
// the occupied voxels of edge length voxel_size, so that densely sampled
// surfaces do not outweigh others. The mean is taken over two grids that are
// shifted by half a voxel against each other. A voxel without counted points is
// left out; without any such voxel the share is 0. Points and verdicts are of
// the same number.
std::vector<double> VoxelMeans(const std::vector<Eigen::Vector3d>& points,
                               const std::vector<PointVerdict>& verdicts,
                               int num_tolerances,
                               double voxel_size);

}  // namespace tsar
