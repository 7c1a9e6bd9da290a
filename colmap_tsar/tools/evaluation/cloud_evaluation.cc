// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/tools/evaluation/meshlab_project.h"
#include "colmap_tsar/tools/evaluation/nearest_distance.h"
#include "colmap_tsar/tools/evaluation/parallel_blocks.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

Eigen::Isometry3d AsMotion(const Eigen::Matrix4d& matrix) {
  Eigen::Isometry3d motion;
  motion.matrix() = matrix;
  return motion;
}

std::vector<double> Completeness(const std::vector<Eigen::Vector3d>& points,
                                 const std::vector<Eigen::Vector3d>& surface,
                                 const CloudEvaluationOptions& options) {
  const std::vector<double>& tolerances = options.tolerances;
  const std::vector<double> distances =
      NearestDistances(surface, points, tolerances.back());
  std::vector<PointVerdict> verdicts(surface.size());
  for (size_t i = 0; i < surface.size(); ++i) {
    const auto first = std::ranges::lower_bound(tolerances, distances[i]);
    verdicts[i].first_good = static_cast<int>(first - tolerances.begin());
  }
  return VoxelMeans(surface,
                    verdicts,
                    static_cast<int>(tolerances.size()),
                    options.voxel_size);
}

std::vector<double> Accuracy(const std::vector<Eigen::Vector3d>& points,
                             const std::vector<PlacedScan>& scans,
                             const CloudEvaluationOptions& options) {
  const int num_tolerances = static_cast<int>(options.tolerances.size());
  // The evidence of one scanner suffices for either verdict.
  std::vector<PointVerdict> verdicts(points.size(), {num_tolerances, false});
  for (const PlacedScan& placed : scans) {
    const LaserScan scan(placed.points, options.beam);
    const Eigen::Isometry3d scan_from_world =
        AsMotion(placed.world_from_scan).inverse();
    ParallelBlocks(points.size(), [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const PointVerdict verdict =
            scan.Judge(scan_from_world * points[i], options.tolerances);
        verdicts[i].first_good =
            std::min(verdicts[i].first_good, verdict.first_good);
        verdicts[i].bad_below |= verdict.bad_below;
      }
    });
  }
  return VoxelMeans(points, verdicts, num_tolerances, options.voxel_size);
}

}  // namespace

void CloudEvaluationOptions::Check() const {
  CheckTolerances(tolerances);
  if (!(voxel_size > 0)) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("voxel_size") + ": must be above 0; give one such as 0.01");
  }
  if (!(beam.start_radius >= 0) || !(beam.divergence_degrees >= 0) ||
      !(beam.divergence_degrees < 45)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("beam_radius") + " and " + OptionName("beam_angle") +
                    ": must be 0 or more, and the "
                    "angle below 45 degrees");
  }
}

CloudEvaluation EvaluateCloud(const std::vector<Eigen::Vector3d>& points,
                              const std::vector<PlacedScan>& scans,
                              const CloudEvaluationOptions& options) {
  options.Check();
  std::vector<Eigen::Vector3d> surface;
  for (const PlacedScan& scan : scans) {
    const Eigen::Isometry3d motion = AsMotion(scan.world_from_scan);
    for (const Eigen::Vector3d& point : scan.points) {
      surface.push_back(motion * point);
    }
  }
  CloudEvaluation evaluation;
  evaluation.num_points = static_cast<int64_t>(points.size());
  evaluation.num_scan_points = static_cast<int64_t>(surface.size());
  const std::vector<double> completeness =
      Completeness(points, surface, options);
  const std::vector<double> accuracy = Accuracy(points, scans, options);
  for (size_t t = 0; t < options.tolerances.size(); ++t) {
    evaluation.scores.push_back({options.tolerances[t],
                                 completeness[t],
                                 accuracy[t],
                                 HarmonicMean(completeness[t], accuracy[t])});
  }
  return evaluation;
}

CloudEvaluation EvaluateCloudFile(const std::filesystem::path& cloud_path,
                                  const std::filesystem::path& project_path,
                                  const CloudEvaluationOptions& options) {
  options.Check();
  RequireNearestDistances();
  const std::vector<Eigen::Vector3d> points = ReadPlyPoints(cloud_path);
  std::vector<PlacedScan> scans;
  bool has_points = false;
  for (const MeshlabScan& scan : ReadMeshlabProject(project_path)) {
    scans.push_back({ReadPlyPoints(scan.path), scan.world_from_scan});
    has_points |= !scans.back().points.empty();
  }
  if (!has_points) {
    throw Error::File(ErrorCode::kMismatch,
                      project_path.string(),
                      "its scans have no points",
                      "give a project whose scans show the scene");
  }
  return EvaluateCloud(points, scans, options);
}

}  // namespace tsar
