// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/superpixel_observations.h"

namespace tsar {

SuperpixelObservations::SuperpixelObservations(
    const std::vector<ObservedView>& views, double max_weight) {
  const Camera& reference = views[0].camera;
  const Eigen::Vector3d origin = reference.Center();
  for (const ObservedView& view : views) {
    const ViewEvidence& evidence = *view.evidence;
    const int number = static_cast<int>(frames_.size());
    frames_.push_back({reference.rotation * (view.camera.Center() - origin),
                       reference.rotation * view.camera.rotation.transpose(),
                       evidence.resolution});
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      const int begin = evidence.first_observation[k];
      const int end = evidence.first_observation[k + 1];
      double confidences = 0.0;
      for (int i = begin; i < end; ++i) {
        confidences += evidence.observations[i].confidence;
      }
      views_.push_back(number);
      entries_.push_back(
          {evidence.observations.data() + begin,
           end - begin,
           std::min(static_cast<double>(evidence.weights[k]), max_weight),
           confidences});
    }
  }
}

DepthObservation SuperpixelObservations::At(int superpixel, int number) const {
  const Entry& entry = entries_[superpixel];
  const Frame& frame = frames_[views_[superpixel]];
  const Observation& observed = entry.observations[number];
  const RayDepth& sample = observed.sample;
  DepthObservation observation;
  observation.center = frame.center;
  observation.ray = frame.rotation * Eigen::Vector3d(sample.x, sample.y, 1.0);
  observation.depth = sample.z;
  observation.sigma = static_cast<double>(sample.z) *
                      frame.resolution.RelativeDepthError(sample.z);
  observation.weight = observed.confidence * entry.weight / entry.confidences;
  return observation;
}

}  // namespace tsar
