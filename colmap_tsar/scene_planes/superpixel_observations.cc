// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/superpixel_observations.h"

#include "colmap_tsar/base/camera.h"

#include <cmath>
#include <optional>

namespace tsar {
namespace {

// Views further apart in the list are not asked what they see of each other.
constexpr size_t kMaxViewsApart = 8;

// The superpixel of a view into which a point in its camera's frame falls.
std::optional<int> SuperpixelAt(const ObservedView& view, const Vec3f& point) {
  if (!(point.z > 0.f)) {
    return std::nullopt;
  }
  float x = 0.f;
  float y = 0.f;
  view.camera.GetIntrinsics().Project(point, &x, &y);
  x = std::round(x);
  y = std::round(y);
  const Image<uint16_t>& superpixels = view.evidence->superpixels;
  const bool is_inside = x >= 0.f && y >= 0.f &&
                         x < static_cast<float>(superpixels.Width()) &&
                         y < static_cast<float>(superpixels.Height());
  return is_inside ? std::optional<int>(
                         superpixels(static_cast<int>(x), static_cast<int>(y)))
                   : std::nullopt;
}

}  // namespace

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
  FindWhereSeen(views);
}

void SuperpixelObservations::FindWhereSeen(
    const std::vector<ObservedView>& views) {
  std::vector<int> first_of_view;
  std::vector<std::vector<RelativePose>> poses(views.size());
  int first = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    first_of_view.push_back(first);
    first += views[i].evidence->NumSuperpixels();
    for (const ObservedView& view : views) {
      poses[i].push_back(ComputeRelativePose(views[i].camera, view.camera));
    }
  }
  first_seen_.push_back(0);
  for (size_t k = 0; k < entries_.size(); ++k) {
    const auto own = static_cast<size_t>(views_[k]);
    const size_t begin = own > kMaxViewsApart ? own - kMaxViewsApart : 0;
    const size_t end = std::min(own + kMaxViewsApart + 1, views.size());
    const Entry& entry = entries_[k];
    for (size_t j = begin; j < end && entry.count > 0; ++j) {
      // Others for each view, in turn.
      const RayDepth& sample =
          entry.observations[j % static_cast<size_t>(entry.count)].sample;
      const std::optional<int> there =
          j == own
              ? std::nullopt
              : SuperpixelAt(
                    views[j],
                    poses[own][j] * (Vec3f{sample.x, sample.y, 1} * sample.z));
      if (there) {
        seen_in_.push_back(first_of_view[j] + *there);
      }
    }
    first_seen_.push_back(seen_in_.size());
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
