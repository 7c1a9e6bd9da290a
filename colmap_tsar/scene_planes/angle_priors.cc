// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/angle_priors.h"

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

}  // namespace tsar
