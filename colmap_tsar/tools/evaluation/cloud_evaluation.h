// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/evaluation/laser_scan.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tsar {

struct CloudEvaluationOptions {
  // Largest distances of a correct point, in units of the points; positive and
  // ascending.
  std::vector<double> tolerances = {0.01, 0.02, 0.05, 0.1};

  // Edge length of the voxels over which scores are averaged, in units of the
  // points.
  double voxel_size = 0.01;

  LaserBeam beam;

  // Throws Error kBadOption.
  void Check() const;
};

// Scores at one tolerance, shares in [0, 1].
struct CloudScore {
  double tolerance = 0;
  // The share of the scanned surface with a reconstructed point within the
  // tolerance.
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
