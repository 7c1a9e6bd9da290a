// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Views of one plane whose depths are known.

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace tsar {

// The plane along direction (which need not have unit length) through a point.
inline WorldPlane PlaneThrough(const Eigen::Vector3d& direction,
                               const Eigen::Vector3d& point) {
  const Eigen::Vector3d normal = direction.normalized();
  return {normal, -normal.dot(point)};
}

// A camera at a place that looks at another.
inline Camera CameraLookingAt(const Eigen::Vector3d& center,
                              const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitY().cross(z).normalized();
  Camera camera;
  camera.rotation.row(0) = x;
  camera.rotation.row(1) = z.cross(x);
  camera.rotation.row(2) = z;
  camera.translation = -camera.rotation * center;
  return camera;
}

// The depth at which the camera's ray, with z = 1 in its frame, meets the
// plane.
inline DepthObservation ObservePlane(const WorldPlane& plane,
                                     const Camera& camera,
                                     const Eigen::Vector3d& ray) {
  DepthObservation observation;
  observation.center = camera.Center();
  observation.ray = camera.rotation.transpose() * ray;
  observation.depth =
      -plane.Height(observation.center) / plane.normal.dot(observation.ray);
  observation.sigma = 0.002 * observation.depth * observation.depth;
  return observation;
}

// A grid of count x count rays within 0.4 of the optical axis.
inline std::vector<DepthObservation> ObservePlane(const WorldPlane& plane,
                                                  const Camera& camera,
                                                  int count) {
  std::vector<DepthObservation> observations;
  for (int row = 0; row < count; ++row) {
    for (int col = 0; col < count; ++col) {
      observations.push_back(ObservePlane(plane,
                                          camera,
                                          {-0.4 + 0.8 * col / (count - 1),
                                           -0.4 + 0.8 * row / (count - 1),
                                           1.0}));
    }
  }
  return observations;
}

// Observed by three cameras, 4 to 5 units in front of the point (0, 0, 4).
inline std::vector<DepthObservation> ObservePlane(const WorldPlane& plane,
                                                  int count) {
  const Eigen::Vector3d target(0.0, 0.0, 4.0);
  std::vector<DepthObservation> observations;
  for (const Eigen::Vector3d& center : {Eigen::Vector3d(0.0, 0.0, 0.0),
                                        Eigen::Vector3d(-1.5, 0.5, -0.2),
                                        Eigen::Vector3d(2.0, -0.4, 0.3)}) {
    const auto of_view =
        ObservePlane(plane, CameraLookingAt(center, target), count);
    observations.insert(observations.end(), of_view.begin(), of_view.end());
  }
  return observations;
}

// Normally distributed with mean 0 and variance 1.
inline double NextNormal(Philox* random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random->NextFloat()));
  return radius * std::cos(2.0 * M_PI * random->NextFloat());
}

// The same depths with errors of the expected size.
inline std::vector<DepthObservation> AddNoise(
    std::vector<DepthObservation> observations, Philox* random) {
  for (DepthObservation& observation : observations) {
    observation.depth += observation.sigma * NextNormal(random);
  }
  return observations;
}

// In degrees, between planes without orientation.
inline double AngleBetween(const WorldPlane& a, const WorldPlane& b) {
  const double sine = a.normal.cross(b.normal).norm();
  return std::asin(std::min(sine, 1.0)) * 180.0 / M_PI;
}

// The plane turned by an angle in degrees about an axis along it through a
// point, then moved along its normal.
inline WorldPlane Displaced(const WorldPlane& plane,
                            const Eigen::Vector3d& point,
                            double degrees,
                            double height) {
  const Eigen::AngleAxisd turn(degrees * M_PI / 180.0,
                               plane.normal.unitOrthogonal());
  const Eigen::Vector3d on_plane =
      point + (height - plane.Height(point)) * plane.normal;
  return PlaneThrough(turn * plane.normal, on_plane);
}

}  // namespace tsar
