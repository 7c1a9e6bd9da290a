// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/plane_export/exported_planes.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

constexpr double kSine15 = 0.25881904510252074;
constexpr double kCosine15 = 0.9659258262890683;
constexpr double kCosine30 = 0.8660254037844387;
// The least length of a meaningful mean of unit vectors.
constexpr double kMinMeanUp = 0.2;

}  // namespace

std::string ToString(PlaneClass of_plane) {
  switch (of_plane) {
    case PlaneClass::kFloor:
      return "floor";
    case PlaneClass::kCeiling:
      return "ceiling";
    case PlaneClass::kWall:
      return "wall";
    case PlaneClass::kOther:
      break;
  }
  return "other";
}

std::string ToString(Vertical::Source source) {
  switch (source) {
    case Vertical::Source::kFrame:
      return "manhattan_frame";
    case Vertical::Source::kCameras:
      return "cameras";
    case Vertical::Source::kNone:
      break;
  }
  return "none";
}

Vertical FindVertical(const std::vector<Eigen::Vector3d>& camera_ups,
                      const std::vector<Eigen::Matrix3d>& frames) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& up : camera_ups) {
    sum += up;
  }
  Vertical vertical;
  if (sum.norm() <= kMinMeanUp * static_cast<double>(camera_ups.size())) {
    return vertical;
  }
  vertical.up = sum.normalized();
  vertical.source = Vertical::Source::kCameras;
  const Eigen::Vector3d mean = vertical.up;
  double best = kCosine30;
  for (const Eigen::Matrix3d& frame : frames) {
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine = frame.col(axis).dot(mean);
      if (std::abs(cosine) > best) {
        best = std::abs(cosine);
        vertical.up = (cosine < 0.0 ? -1.0 : 1.0) * frame.col(axis);
        vertical.source = Vertical::Source::kFrame;
      }
    }
  }
  return vertical;
}

PlaneClass ClassifyPlane(const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& point,
                         const std::vector<Eigen::Vector3d>& cameras,
                         const Vertical& vertical) {
  if (vertical.source == Vertical::Source::kNone) {
    return PlaneClass::kOther;
  }
  const double cosine = normal.dot(vertical.up);
  if (std::abs(cosine) <= kSine15) {
    return PlaneClass::kWall;
  }
  if (std::abs(cosine) < kCosine15 || cameras.empty()) {
    return PlaneClass::kOther;
  }
  const Eigen::Vector3d upwards = (cosine < 0.0 ? -1.0 : 1.0) * normal;
  const auto num_above =
      std::ranges::count_if(cameras, [&](const Eigen::Vector3d& camera) {
        return upwards.dot(camera - point) > 0.0;
      });
  return 2 * static_cast<size_t>(num_above) >= cameras.size()
             ? PlaneClass::kFloor
             : PlaneClass::kCeiling;
}

}  // namespace tsar
