// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/source_selector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kAnglePercentile = 0.75;

// Sources within this triangulation angle of each other show the same: it is
// about the two pixels of parallax, in maps 640 pixels wide, within which views
// agree.
constexpr double kSamePlaceDegrees = 0.2;

// Whether the triangulation angle of a point reaches the angle of this tangent.
// Beyond a right angle its supplement is used, since opposite rays locate a
// point no better than parallel ones.
bool HasAngle(const Eigen::Vector3d& center_a,
              const Eigen::Vector3d& center_b,
              const Eigen::Vector3d& point,
              double min_tangent) {
  const Eigen::Vector3d ray_a = point - center_a;
  const Eigen::Vector3d ray_b = point - center_b;
  const double sine = ray_a.cross(ray_b).norm();
  const double cosine = std::abs(ray_a.dot(ray_b));
  // A point in a camera's center (both are 0) has no angle.
  return sine >= min_tangent * cosine && (sine > 0.0 || min_tangent <= 0.0);
}

// Whether the percentile of the angles reaches the minimum: at most its rank of
// them are too small.
bool ReachesPercentile(int64_t num_small, int64_t num_angles) {
  const auto rank = static_cast<int64_t>(
      std::round(kAnglePercentile * static_cast<double>(num_angles - 1)));
  return num_angles > 0 && num_small <= rank;
}

}  // namespace

SourceSelector::SourceSelector(const SparseModel& model,
                               double min_triangulation_angle_degrees)
    : model_(model),
      min_tangent_(
          std::tan(min_triangulation_angle_degrees * std::numbers::pi / 180.0)),
      track_begins_(model.points.size() + 1, 0) {
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
      track_images_[ends[point]++] = static_cast<int>(i);
    }
  }
}

std::vector<int> SourceSelector::SelectSources(int reference,
                                               int max_num_sources) const {
  const SparseModel::ModelImage& image =
      model_.images.at(static_cast<size_t>(reference));
  std::vector<int64_t> num_shared(model_.images.size(), 0);
  std::vector<int> candidates;
  for (const int point : image.point_indices) {
    for (const int other : TrackOf(point)) {
      if (other != reference && num_shared[other]++ == 0) {
        candidates.push_back(other);
      }
    }
  }
  std::ranges::sort(candidates, [&](int a, int b) {
    const int64_t shared_a = num_shared[a];
    const int64_t shared_b = num_shared[b];
    return shared_a != shared_b ? shared_a > shared_b : a < b;
  });

  const std::vector<Eigen::Vector3d> points = PointsOf(reference);
  std::vector<int> sources;
  for (const int candidate : candidates) {
    if (static_cast<int>(sources.size()) >= max_num_sources) {
      break;
    }
    if (HasTriangulationAngle(reference, candidate) &&
        IsIndependent(points, candidate, sources)) {
      sources.push_back(candidate);
    }
  }
  return sources;
}

std::vector<int> SourceSelector::SelectIndependent(
    int reference, const std::vector<int>& images) const {
  const std::vector<Eigen::Vector3d> points = PointsOf(reference);
  if (points.empty()) {
    return images;
  }
  std::vector<int> sources;
  for (const int image : images) {
    if (ReachAngle(points, reference, image, min_tangent_) &&
        IsIndependent(points, image, sources)) {
      sources.push_back(image);
    }
  }
  return sources;
}

bool SourceSelector::HasOverlap(int reference) const {
  const std::vector<int>& points = model_.images[reference].point_indices;
  return std::ranges::any_of(points, [&](int point) {
    return std::ranges::any_of(TrackOf(point),
                               [&](int image) { return image != reference; });
  });
}

std::span<const int> SourceSelector::TrackOf(int point) const {
  const auto i = static_cast<size_t>(point);
  return std::span(track_images_)
      .subspan(track_begins_[i], track_begins_[i + 1] - track_begins_[i]);
}

std::vector<Eigen::Vector3d> SourceSelector::PointsOf(int reference) const {
  const std::vector<int>& indices = model_.images[reference].point_indices;
  const size_t count = std::min(indices.size(), kMaxNumPoints);
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < count; ++i) {
    points.push_back(model_.points[indices[i * indices.size() / count]]);
  }
  return points;
}

bool SourceSelector::ReachAngle(const std::vector<Eigen::Vector3d>& points,
                                int image_a,
                                int image_b,
                                double min_tangent) const {
  const Eigen::Vector3d& center_a = centers_[image_a];
  const Eigen::Vector3d& center_b = centers_[image_b];
  const auto num_small =
      std::ranges::count_if(points, [&](const Eigen::Vector3d& point) {
        return !HasAngle(center_a, center_b, point, min_tangent);
      });
  return ReachesPercentile(num_small, static_cast<int64_t>(points.size()));
}

bool SourceSelector::IsIndependent(const std::vector<Eigen::Vector3d>& points,
                                   int image,
                                   const std::vector<int>& sources) const {
  static const double min_tangent =
      std::tan(kSamePlaceDegrees * std::numbers::pi / 180.0);
  return std::ranges::all_of(sources, [&](int source) {
    return ReachAngle(points, image, source, min_tangent);
  });
}

bool SourceSelector::HasTriangulationAngle(int reference, int source) const {
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
      num_small +=
          HasAngle(centers_[a], centers_[b], model_.points[point], min_tangent_)
              ? 0
              : 1;
    }
  }
  return ReachesPercentile(num_small, num_angles);
}

}  // namespace tsar
