// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/thread_pool.h"
#include "colmap_tsar/io/ply.h"
#include "colmap_tsar/tools/evaluation/meshlab_project.h"
#include "colmap_tsar/tools/evaluation/nearest_distance.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

using Voxel = std::array<int64_t, 3>;
using PointInVoxel = std::pair<Voxel, size_t>;

Voxel VoxelOf(const Eigen::Vector3d& point, double shift, double voxel_size) {
  // At larger distances doubles are coarser than voxels.
  constexpr double kFurthest = 1e15;
  Voxel voxel;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = static_cast<int64_t>(std::clamp(
        std::floor(point[axis] / voxel_size + shift), -kFurthest, kFurthest));
  }
  return voxel;
}

constexpr double kCellsPerUnit = 256;

// Beyond this sine of the angle of a beam, all points are tested sooner.
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
  ThreadPool threads(-1);
  for (const PlacedScan& placed : scans) {
    const LaserScan scan(placed.points, options.beam);
    const Eigen::Isometry3d scan_from_world =
        Eigen::Isometry3d(placed.world_from_scan).inverse();
    threads.ForEach(points.size(), [&](size_t i) {
      const PointVerdict verdict =
          scan.Judge(scan_from_world * points[i], options.tolerances);
      verdicts[i].first_good =
          std::min(verdicts[i].first_good, verdict.first_good);
      verdicts[i].bad_below |= verdict.bad_below;
    });
  }
  return VoxelMeans(points, verdicts, num_tolerances, options.voxel_size);
}

}  // namespace

std::vector<double> VoxelMeans(const std::vector<Eigen::Vector3d>& points,
                               const std::vector<PointVerdict>& verdicts,
                               int num_tolerances,
                               double voxel_size) {
  std::vector<double> shares(num_tolerances);  // Sums over voxels.
  std::vector<int64_t> num_voxels(num_tolerances);
  std::vector<PointInVoxel> sorted(points.size());
  for (const double shift : {0.0, 0.5}) {
    for (size_t i = 0; i < points.size(); ++i) {
      sorted[i] = {VoxelOf(points[i], shift, voxel_size), i};
    }
    std::ranges::sort(sorted);
    for (auto begin = sorted.begin(); begin != sorted.end();) {
      const auto end =
          std::find_if(begin, sorted.end(), [&](const PointInVoxel& point) {
            return point.first != begin->first;
          });
      for (int t = 0; t < num_tolerances; ++t) {
        int64_t num_good = 0;
        int64_t num_counted = 0;
        for (auto point = begin; point != end; ++point) {
          const PointVerdict& verdict = verdicts[point->second];
          num_good += verdict.first_good <= t;
          num_counted += verdict.first_good <= t || verdict.bad_below;
        }
        if (num_counted > 0) {
          shares[t] += static_cast<double>(num_good) / num_counted;
          ++num_voxels[t];
        }
      }
      begin = end;
    }
  }
  for (int t = 0; t < num_tolerances; ++t) {
    shares[t] /= static_cast<double>(std::max<int64_t>(num_voxels[t], 1));
  }
  return shares;
}

LaserScan::LaserScan(std::vector<Eigen::Vector3d> points, const LaserBeam& beam)
    : beam_(beam) {
  std::vector<std::pair<uint64_t, size_t>> order(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    order[i] = {CellKeyOf(points[i].normalized()), i};
  }
  std::ranges::sort(order);
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
                    ": must be 0 or more, and the angle below 45 degrees");
  }
}

CloudEvaluation EvaluateCloud(const std::vector<Eigen::Vector3d>& points,
                              const std::vector<PlacedScan>& scans,
                              const CloudEvaluationOptions& options) {
  options.Check();
  std::vector<Eigen::Vector3d> surface;
  for (const PlacedScan& scan : scans) {
    const Eigen::Isometry3d motion(scan.world_from_scan);
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
