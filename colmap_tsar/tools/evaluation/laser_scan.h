// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The verdict on a point at a list of ascending tolerances: good from index
// first_good on, and below that either bad or not counted.
struct PointVerdict {
  int first_good = 0;
  bool bad_below = true;
};

// The share of good among the counted points at each tolerance, averaged over
// the occupied voxels of edge length voxel_size, so that densely sampled
// surfaces do not outweigh others. The mean is taken over two grids that are
// shifted by half a voxel against each other. A voxel without counted points is
// left out; without any such voxel the share is 0. points and verdicts have the
// same size.
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

// One laser scan as evidence about space: free between the scanner and each
// scan point, a surface at the scan point, unknown behind it.
class LaserScan {
 public:
  // Points in the scanner's frame: the scanner is at (0, 0, 0).
  LaserScan(std::vector<Eigen::Vector3d> points, const LaserBeam& beam);

  // The verdict of the beams through this point: good from the smallest of the
  // ascending tolerances that is not below its distance to the end of one of
  // these beams; bad below that if one of them reaches beyond the point;
  // otherwise not counted.
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
