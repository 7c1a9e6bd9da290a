// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Planes that views measure with known errors.

#include "colmap_tsar/scene/adjustment/adjust_planes.h"

#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/synthetic_observations.h"

namespace tsar {

inline double Radians(double degrees) { return degrees * M_PI / 180.0; }

// A part of a plane, given by its middle and by the vectors from there to the
// middles of two sides.
struct Patch {
  Eigen::Vector3d middle;
  Eigen::Vector3d half_length;
  Eigen::Vector3d half_width;

  WorldPlane Plane() const {
    return PlaneThrough(half_length.cross(half_width), middle);
  }
};

// Added to the inverse depths at (u, v) in [-1, 1]^2 of the patch, in expected
// errors.
struct Bias {
  double shift = 0.0;
  double lean_u = 0.0;
  double lean_v = 0.0;
};

// count x count observations with errors of 0.002 of the squared depth, with
// this bias, and with noise if `random` is not null.
inline std::vector<DepthObservation> ObservePatch(const Patch& patch,
                                                  const Eigen::Vector3d& center,
                                                  int count,
                                                  const Bias& bias = {},
                                                  Philox* random = nullptr) {
  std::vector<DepthObservation> observations;
  const Camera camera = CameraLookingAt(center, patch.middle);
  for (int i = 0; i < count * count; ++i) {
    const double u = 2.0 * (i % count) / (count - 1) - 1.0;
    const double v = 2.0 * (i / count) / (count - 1) - 1.0;
    const Eigen::Vector3d point =
        patch.middle + u * patch.half_length + v * patch.half_width;
    DepthObservation observation;
    observation.center = camera.Center();
    const Eigen::Vector3d in_camera = camera.rotation * (point - center);
    observation.ray = (point - center) / in_camera.z();
    double error = bias.shift + bias.lean_u * u + bias.lean_v * v;
    if (random != nullptr) {
      error += NextNormal(random);
    }
    observation.depth = 1.0 / (1.0 / in_camera.z() + 0.002 * error);
    observation.sigma = 0.002 * observation.depth * observation.depth;
    observations.push_back(observation);
  }
  return observations;
}

// What each view saw of which plane.
using Observations = std::vector<std::pair<int, std::vector<DepthObservation>>>;

inline MeasurePlanes Measure(const Observations& observations,
                             const MeasurePlaneOptions& options = {}) {
  return [&observations, options](const std::vector<ModelPlane>& planes) {
    std::vector<PlaneMeasurement> measurements;
    for (const auto& [plane, of_view] : observations) {
      measurements.push_back(
          MeasurePlane(plane, planes[plane].plane, of_view, options));
    }
    return measurements;
  };
}

// The turns about the two axes and the shift that take the adjusted plane to
// the true one.
inline Eigen::Vector3d ErrorOf(const ModelPlane& plane,
                               const WorldPlane& truth) {
  const double sign = plane.plane.normal.dot(truth.normal) < 0.0 ? -1.0 : 1.0;
  const Eigen::Vector3d normal = sign * truth.normal;
  return {-normal.dot(plane.axis_t),
          normal.dot(plane.axis_s),
          -sign * truth.Height(plane.center)};
}

// Squared, in standard deviations: 3 is expected.
inline double SquaredError(const ModelPlane& plane, const WorldPlane& truth) {
  const Eigen::Vector3d error = ErrorOf(plane, truth);
  return error.dot(plane.covariance.inverse() * error);
}

}  // namespace tsar
