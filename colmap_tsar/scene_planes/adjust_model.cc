// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/adjust_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// 3 degrees, and 0.5.
constexpr double kSinMaxAngle = 0.0523;
constexpr double kSigma = 0.00873;
// A plane leans on so many others, of so many of its component.
constexpr int kMaxPartners = 3;
constexpr size_t kMaxTried = 30;

std::optional<PlaneAnglePrior> FindPrior(const std::vector<ModelPlane>& planes,
                                         int first,
                                         int second) {
  const Eigen::Vector3d& a = planes[static_cast<size_t>(first)].plane.normal;
  const Eigen::Vector3d& b = planes[static_cast<size_t>(second)].plane.normal;
  if (std::abs(a.dot(b)) < kSinMaxAngle) {
    return PlaneAnglePrior{
        PlaneAnglePrior::Kind::kOrthogonal, first, second, kSigma};
  }
  if (a.cross(b).norm() < kSinMaxAngle) {
    return PlaneAnglePrior{
        PlaneAnglePrior::Kind::kParallel, first, second, kSigma};
  }
  return std::nullopt;
}

// Beyond what rounding leaves.
bool IsAlongAxis(const ModelPlane& plane,
                 const std::vector<Eigen::Matrix3d>& frames) {
  return plane.frame >= 0 && frames[static_cast<size_t>(plane.frame)]
                                     .col(plane.axis)
                                     .cross(plane.plane.normal)
                                     .norm() < 1e-9;
}

// What is known of the adjusted plane, for one that is a little beside it.
void SetKnowledge(const AdjustedPlane& from, ModelPlane* plane) {
  plane->covariance = from.covariance;
  // Otherwise the middle is not amid what was measured.
  if (!std::isfinite(from.covariance(2, 2))) {
    return;
  }
  const Eigen::Vector3d& normal = plane->plane.normal;
  plane->center = from.center - plane->plane.Height(from.center) * normal;
  plane->axis_s = (from.axis_s - from.axis_s.dot(normal) * normal).normalized();
  plane->axis_t = normal.cross(plane->axis_s);
}

}  // namespace

std::vector<PlaneAnglePrior> FindAnglePriors(
    const std::vector<ModelPlane>& planes) {
  std::map<int, std::vector<int>> tried;  // By component.
  std::vector<PlaneAnglePrior> priors;
  for (int p = 0; p < static_cast<int>(planes.size()); ++p) {
    const ModelPlane& plane = planes[static_cast<size_t>(p)];
    std::vector<int>& before = tried[plane.component];
    int num_partners = 0;
    for (size_t i = 0;
         i < before.size() && num_partners < kMaxPartners && plane.axis < 0;
         ++i) {
      if (const auto prior = FindPrior(planes, before[i], p)) {
        priors.push_back(*prior);
        ++num_partners;
      }
    }
    if (before.size() < kMaxTried) {
      before.push_back(p);
    }
  }
  return priors;
}

void AdjustModel(const MeasurePlanes& measure,
                 const std::vector<bool>& may_move,
                 SceneModel* model) {
  PlaneAdjustment adjustment;
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (!may_move[p] && !IsAlongAxis(plane, model->frames)) {
      plane.frame = plane.axis = -1;
    }
    adjustment.planes.push_back(plane.plane);
    adjustment.axes.push_back({plane.frame, plane.axis});
  }
  adjustment.frames = model->frames;
  adjustment.angles = FindAnglePriors(model->planes);
  AdjustPlanesOptions options;
  if (std::find(may_move.begin(), may_move.end(), true) == may_move.end()) {
    options.max_rounds = 1;  // Planes have to be measured once only.
  }
  const AdjustedPlanes adjusted = AdjustPlanes(adjustment, measure, options);
  for (size_t p = 0; p < model->planes.size(); ++p) {
    ModelPlane& plane = model->planes[p];
    if (may_move[p]) {
      plane.plane = adjusted.planes[p].plane;
      if (plane.frame >= 0) {
        const auto frame = static_cast<size_t>(plane.frame);
        model->frames[frame] = adjusted.frames[frame];
      }
    }
    SetKnowledge(adjusted.planes[p], &plane);
  }
}

}  // namespace tsar
