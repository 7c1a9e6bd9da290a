// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/world_plane.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace tsar {
namespace {

// Observations closer than this share of their distance from the cameras
// coincide up to rounding.
constexpr double kSamePosition = 1e-6;

// The information on the height, one over its variance.
double Information(const WorldPlane& plane,
                   const DepthObservation& observation) {
  const double sigma = observation.sigma * RaySlope(plane, observation);
  return observation.weight / (sigma * sigma);
}

}  // namespace

WorldPlane ToWorldPlane(const Plane& plane, const Camera& camera) {
  const Eigen::Vector3d normal(plane.normal.x, plane.normal.y, plane.normal.z);
  // A normal in single precision has unit length only nearly.
  const double scale = 1.0 / normal.norm();
  return {scale * (camera.rotation.transpose() * normal),
          scale * (plane.offset + normal.dot(camera.translation))};
}

Plane ToCameraPlane(const WorldPlane& plane, const Camera& camera) {
  Eigen::Vector3d normal = camera.rotation * plane.normal;
  double offset = plane.offset - normal.dot(camera.translation);
  if (offset < 0.0) {
    normal = -normal;
    offset = -offset;
  }
  return {{static_cast<float>(normal.x()),
           static_cast<float>(normal.y()),
           static_cast<float>(normal.z())},
          static_cast<float>(offset)};
}

double RaySlope(const WorldPlane& plane, const DepthObservation& observation) {
  constexpr double kMinSlope = 0.05;
  return std::max(std::abs(plane.normal.dot(observation.ray)),
                  kMinSlope * observation.ray.norm());
}

double NormalizedResidual(const WorldPlane& plane,
                          const DepthObservation& observation) {
  return plane.Height(observation.Point()) /
         (RaySlope(plane, observation) * observation.sigma);
}

Eigen::Vector3d FootPoint(const WorldPlane& plane,
                          const DepthObservation& observation) {
  const Eigen::Vector3d point = observation.Point();
  const double step = plane.Height(point) / RaySlope(plane, observation);
  const bool along_normal = plane.normal.dot(observation.ray) > 0.0;
  return point + (along_normal ? -step : step) * observation.ray;
}

double PlaneUncertainty::Sigma(const Eigen::Vector3d& point) const {
  const Eigen::Vector2d position = axes.transpose() * (point - center);
  double variance = height_variance;
  for (int i = 0; i < 2; ++i) {
    if (std::isfinite(slope_variance[i])) {
      variance += slope_variance[i] * position[i] * position[i];
    } else if (!(std::abs(position[i]) <= position_tolerance)) {
      return std::numeric_limits<double>::infinity();
    }
  }
  return std::sqrt(variance);
}

PlaneUncertainty ComputeUncertainty(
    const WorldPlane& plane,
    const std::vector<DepthObservation>& observations) {
  PlaneUncertainty uncertainty;
  double information = 0.0;
  double distance = 0.0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const DepthObservation& observation : observations) {
    const double share = Information(plane, observation);
    information += share;
    distance += share * observation.depth * observation.ray.norm();
    center += share * FootPoint(plane, observation);
  }
  if (!(information > 0.0)) {
    return uncertainty;
  }
  center /= information;
  distance /= information;

  Eigen::Matrix<double, 3, 2> tangents;
  tangents.col(0) = plane.normal.unitOrthogonal();
  tangents.col(1) = plane.normal.cross(tangents.col(0));
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const DepthObservation& observation : observations) {
    const Eigen::Vector2d position =
        tangents.transpose() * (FootPoint(plane, observation) - center);
    scatter +=
        Information(plane, observation) * position * position.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(scatter);

  uncertainty.center = center;
  uncertainty.height_variance = 1.0 / information;
  uncertainty.position_tolerance = kSamePosition * distance;
  for (int i = 0; i < 2; ++i) {
    // Eigen sorts by ascending values.
    const double value = solver.eigenvalues()[1 - i];
    uncertainty.axes.col(i) = tangents * solver.eigenvectors().col(1 - i);
    if (value / information > std::pow(uncertainty.position_tolerance, 2)) {
      uncertainty.slope_variance[i] = 1.0 / value;
    }
  }
  return uncertainty;
}

}  // namespace tsar
