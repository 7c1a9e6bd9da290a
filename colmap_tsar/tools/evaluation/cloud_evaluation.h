// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/evaluation/laser_scan.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tsar {

struct CloudEvaluationOptions {
  // Distances up to which a point counts as right, in units of the points;
  // positive and rising.
  std::vector<double> tolerances = {0.01, 0.02, 0.05, 0.1};

  // Edge length of the voxels over which scores are averaged, in units of the
  // points.
  double voxel_size = 0.01;

  LaserBeam beam;

  // Throws Error kBadOption.
  void Check() const;
};

// Shares in [0, 1].
struct CloudScore {
  double tolerance = 0;
  // Of the scanned surface, the part with a reconstructed point within the
  // tolerance.
  double completeness = 0;
  // Of the reconstructed points in space that the scanners saw, those within
  // the tolerance of the surface. Where no scanner looked, nothing is counted.
  double accuracy = 0;
  double f1 = 0;  // The harmonic mean of both.
};

struct CloudEvaluation {
  int64_t num_points = 0;
  int64_t num_scan_points = 0;
  std::vector<CloudScore> scores;  // One per tolerance.
};

// A scan's points in the scanner's frame, and where the scanner stood.
struct PlacedScan {
  std::vector<Eigen::Vector3d> points;
  Eigen::Matrix4d world_from_scan;  // A rigid motion.
};

// The measure of the ETH3D multi-view benchmark (Schoeps et al., "A Multi-View
// Stereo Benchmark with High-Resolution Images and Multi-Camera Videos", CVPR
// 2017). Cloud and scans in the same frame and units.
CloudEvaluation EvaluateCloud(const std::vector<Eigen::Vector3d>& points,
                              const std::vector<PlacedScan>& scans,
                              const CloudEvaluationOptions& options);

// The same from files: a PLY file and a MeshLab project that lists the scans.
// Throws what RequireNearestDistances, ReadPlyPoints and ReadMeshlabProject
// throw, and kMismatch where the scans have no points.
CloudEvaluation EvaluateCloudFile(const std::filesystem::path& cloud_path,
                                  const std::filesystem::path& project_path,
                                  const CloudEvaluationOptions& options);

}  // namespace tsar
