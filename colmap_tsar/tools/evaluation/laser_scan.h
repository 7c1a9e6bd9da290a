// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <unordered_map>
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

// The laser beam: a cone around the ray from the scanner. The defaults are
// ETH3D's, for a Faro X 330 and points in meters.
struct LaserBeam {
  double start_radius = 0.001125;     // At the scanner, units of the points.
  double divergence_degrees = 0.011;  // Half the opening angle.
};

// One laser scan as evidence about space: on the way from the scanner to each
// scan point there is nothing, at the scan point there is a surface, and behind
// it nothing is known.
class LaserScan {
 public:
  // Points in the scanner's frame: the scanner is at (0, 0, 0).
  LaserScan(std::vector<Eigen::Vector3d> points, const LaserBeam& beam);

  // What the beams that pass through this point say about it: good from the
  // smallest of the rising tolerances that is not below its distance to the end
  // of one of these beams; bad below that if one of them reaches beyond the
  // point; otherwise not counted.
  PointVerdict Judge(const Eigen::Vector3d& point,
                     const std::vector<double>& tolerances) const;

 private:
  struct PointRange {
    size_t begin = 0;
    size_t end = 0;
  };

  std::vector<Eigen::Vector3d> points_;      // Ordered by the cells below.
  std::vector<Eigen::Vector3d> directions_;  // Unit vectors to the points.
  // The cube around the unit sphere is cut into small cells; each holds the
  // directions that end in it. Unlike angles, this has no poles and no seam.
  std::unordered_map<uint64_t, PointRange> cells_;
  LaserBeam beam_;
};

}  // namespace tsar
