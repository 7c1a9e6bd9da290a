// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/source_selection.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kAnglePercentile = 0.75;

// Whether two cameras see a point under at least an angle of this tangent.
// Beyond a right angle its supplement counts, since rays that meet head-on
// locate a point no better than parallel ones.
bool HasAngle(const Eigen::Vector3d& center_a,
              const Eigen::Vector3d& center_b,
              const Eigen::Vector3d& point,
              double min_tangent) {
  const Eigen::Vector3d ray_a = point - center_a;
  const Eigen::Vector3d ray_b = point - center_b;
  const double sine = ray_a.cross(ray_b).norm();
  const double cosine = std::abs(ray_a.dot(ray_b));
  // A point in a camera's centre, where both are 0, has no angle.
  return sine >= min_tangent * cosine && (sine > 0.0 || min_tangent <= 0.0);
}

}  // namespace

SourceSelector::SourceSelector(const SparseModel& model)
    : model_(model), track_begins_(model.points.size() + 1, 0) {
  for (const SparseModel::ModelImage& image : model.images) {
    centers_.push_back(image.camera.Center());
    for (const int point : image.point_indices) {
      ++track_begins_[static_cast<size_t>(point) + 1];
    }
  }
  for (size_t i = 1; i < track_begins_.size(); ++i) {
    track_begins_[i] += track_begins_[i - 1];
  }
  track_images_.resize(track_begins_.back());
  std::vector<size_t> ends = track_begins_;
  for (size_t i = 0; i < model.images.size(); ++i) {
    for (const int point : model.images[i].point_indices) {
      track_images_[ends[static_cast<size_t>(point)]++] = static_cast<int>(i);
    }
  }
}

std::vector<int> SourceSelector::SelectSources(
    int reference,
    int max_num_sources,
    double min_triangulation_angle_degrees) const {
  const SparseModel::ModelImage& image =
      model_.images.at(static_cast<size_t>(reference));
  std::vector<int64_t> num_shared(model_.images.size(), 0);
  std::vector<int> candidates;
  for (const int point : image.point_indices) {
    const auto p = static_cast<size_t>(point);
    for (size_t i = track_begins_[p]; i < track_begins_[p + 1]; ++i) {
      const int other = track_images_[i];
      if (other != reference && num_shared[static_cast<size_t>(other)]++ == 0) {
        candidates.push_back(other);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end(), [&](int a, int b) {
    const int64_t shared_a = num_shared[static_cast<size_t>(a)];
    const int64_t shared_b = num_shared[static_cast<size_t>(b)];
    return shared_a != shared_b ? shared_a > shared_b : a < b;
  });

  const double min_tangent =
      std::tan(min_triangulation_angle_degrees * std::numbers::pi / 180.0);
  std::vector<int> sources;
  for (const int candidate : candidates) {
    if (static_cast<int>(sources.size()) >= max_num_sources) {
      break;
    }
    if (HasTriangulationAngle(reference, candidate, min_tangent)) {
      sources.push_back(candidate);
    }
  }
  return sources;
}

bool SourceSelector::HasTriangulationAngle(int reference,
                                           int source,
                                           double min_tangent) const {
  const auto a = static_cast<size_t>(reference);
  const auto b = static_cast<size_t>(source);
  const std::vector<int>& points_b = model_.images[b].point_indices;
  int64_t num_angles = 0;
  int64_t num_small = 0;
  // Both lists ascend. A point that is observed several times counts once for
  // each pair of observations, as in the number of shared points.
  auto run = points_b.begin();
  for (const int point : model_.images[a].point_indices) {
    while (run != points_b.end() && *run < point) {
      ++run;
    }
    for (auto it = run; it != points_b.end() && *it == point; ++it) {
      ++num_angles;
      num_small += HasAngle(centers_[a],
                            centers_[b],
                            model_.points[static_cast<size_t>(point)],
                            min_tangent)
                       ? 0
                       : 1;
    }
  }
  // The angle of this rank is large enough when no more than that many before
  // it are too small.
  const auto rank = static_cast<int64_t>(
      std::round(kAnglePercentile * static_cast<double>(num_angles - 1)));
  return num_angles > 0 && num_small <= rank;
}

}  // namespace tsar
