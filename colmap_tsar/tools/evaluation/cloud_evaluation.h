// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
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
// shifted by half a voxel against each other. Voxels without counted points are
// left out; the share is 0 without others. points and verdicts have one size.
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
  // ascending tolerances not below its distance to the end of one of these
  // beams; bad below that if one reaches beyond it; else not counted.
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

struct CloudEvaluationOptions {
  // Largest distances of a correct point, in their units; positive, ascending.
  std::vector<double> tolerances = {0.01, 0.02, 0.05, 0.1};
  // Edge length of the voxels to average scores over, in units of the points.
  double voxel_size = 0.01;
  LaserBeam beam;

  // Throws Error kBadOption.
  void Check() const;
};

// Scores at one tolerance, shares in [0, 1].
struct CloudScore {
  double tolerance = 0;
  // The share of the scanned surface with a point within the tolerance.
  double completeness = 0;
  // The share of the reconstructed points in observed space that are within the
  // tolerance of the surface. Unobserved space is not counted.
  double accuracy = 0;
  double f1 = 0;  // The harmonic mean of both.
};

struct CloudEvaluation {
  int64_t num_points = 0;
  int64_t num_scan_points = 0;
  std::vector<CloudScore> scores;  // One per tolerance.
};

// A scan's points in the scanner's frame, and the scanner's pose.
struct PlacedScan {
  std::vector<Eigen::Vector3d> points;
  Eigen::Matrix4d world_from_scan;  // A rigid motion.
};

// Evaluates a cloud as the ETH3D multi-view benchmark does (Schoeps et al., "A
// Multi-View Stereo Benchmark with High-Resolution Images and Multi-Camera
// Videos", CVPR 2017). Cloud and scans in the same frame and units.
CloudEvaluation EvaluateCloud(const std::vector<Eigen::Vector3d>& points,
                              const std::vector<PlacedScan>& scans,
                              const CloudEvaluationOptions& options);

// Evaluates files: a PLY file and a MeshLab project that lists the scans.
// Throws the errors of RequireNearestDistances, ReadPlyPoints and
// ReadMeshlabProject, and kMismatch if the scans have no points.
CloudEvaluation EvaluateCloudFile(const std::filesystem::path& cloud_path,
                                  const std::filesystem::path& project_path,
                                  const CloudEvaluationOptions& options);

}  // namespace tsar
