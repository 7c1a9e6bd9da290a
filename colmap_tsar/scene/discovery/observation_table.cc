// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/discovery/observation_table.h"

#include <algorithm>

namespace tsar {

ObservationTable::ObservationTable(const std::vector<ObservedView>& views,
                                   ObservationsOf which) {
  slack_ = which == ObservationsOf::kPriors ? kSlackOfPrior : 0.0;
  const Camera& reference = views[0].camera;
  const Eigen::Vector3d origin = reference.Center();
  for (const ObservedView& view : views) {
    const ViewEvidence& evidence = *view.evidence;
    const int view_index = static_cast<int>(frames_.size());
    frames_.push_back({reference.rotation * (view.camera.Center() - origin),
                       reference.rotation * view.camera.rotation.transpose(),
                       evidence.resolution,
                       Count()});
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      int begin = evidence.first_observation[k];
      int end = evidence.first_observation[k + 1];
      const auto sum_confidences = [&] {
        double sum = 0.0;
        for (int i = begin; i < end; ++i) {
          sum += evidence.observations[i].confidence;
        }
        return sum;
      };
      const double all = sum_confidences();
      double weight = evidence.weights[k];
      double confidences = all;
      const int first_of_prior = evidence.FirstOfPrior(k);
      if (first_of_prior < end) {
        (which == ObservationsOf::kViews ? end : begin) = first_of_prior;
        confidences = sum_confidences();
        weight *= confidences / all;
      } else if (which == ObservationsOf::kPriors) {
        begin = end;
      }
      views_.push_back(view_index);
      entries_.push_back(
          {evidence.observations.data() + begin,
           evidence.errors.empty() ? nullptr : evidence.errors.data() + begin,
           end - begin,
           std::min(weight, kMaxSuperpixelWeight),
           confidences});
    }
  }
}

DepthObservation ObservationTable::At(int superpixel, int index) const {
  const Entry& entry = entries_[superpixel];
  const Frame& frame = frames_[views_[superpixel]];
  const Observation& observed = entry.observations[index];
  const RayDepth& sample = observed.sample;
  DepthObservation observation;
  observation.center = frame.center;
  observation.ray = frame.rotation * Eigen::Vector3d(sample.x, sample.y, 1.0);
  observation.depth = sample.z;
  observation.sigma = double{sample.z} *
                      frame.resolution.RelativeDepthError(sample.z) *
                      (entry.errors == nullptr ? 1.f : entry.errors[index]);
  observation.weight = observed.confidence * entry.weight / entry.confidences;
  observation.slack = slack_;
  return observation;
}

}  // namespace tsar
