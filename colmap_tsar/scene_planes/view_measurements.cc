// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/view_measurements.h"

#include "colmap_tsar/scene_planes/superpixel_observations.h"

#include <cstddef>
#include <map>

#include <Eigen/Core>

namespace tsar {

std::vector<PlaneMeasurement> MeasureView(const ObservedView& view,
                                          const std::vector<int>& assignment,
                                          const std::vector<WorldPlane>& planes,
                                          const MeasureViewOptions& options) {
  const SuperpixelObservations observations({view}, options.max_weight);
  std::map<int, std::vector<int>> superpixels;  // By plane.
  for (size_t k = 0; k < assignment.size(); ++k) {
    if (assignment[k] >= 0) {
      superpixels[assignment[k]].push_back(static_cast<int>(k));
    }
  }
  const Eigen::Matrix3d to_world = view.camera.rotation.transpose();
  const Eigen::Vector3d center = view.camera.Center();
  std::vector<PlaneMeasurement> measurements;
  for (const auto& [plane, members] : superpixels) {
    std::vector<DepthObservation> of_plane;
    for (const int k : members) {
      for (int i = 0; i < observations.NumObservations(k); ++i) {
        DepthObservation observation = observations.At(k, i);
        observation.center = center;
        observation.ray = to_world * observation.ray;
        observation.sigma *= options.tolerance * options.error_share;
        observation.weight /= options.full_weight;
        of_plane.push_back(observation);
      }
    }
    const PlaneMeasurement measurement = MeasurePlane(
        plane, planes[static_cast<size_t>(plane)], of_plane, options.planes);
    if (measurement.information > 0.0) {
      measurements.push_back(measurement);
    }
  }
  return measurements;
}

}  // namespace tsar
