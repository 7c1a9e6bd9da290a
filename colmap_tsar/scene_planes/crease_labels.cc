// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/crease_labels.h"

#include "colmap_tsar/scene_planes/superpixel_rays.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace tsar {
namespace {

// What a pixel costs on a plane that ends before it: more than a region's plane
// or neighbours can outweigh.
constexpr float kCostBeyond = 0.3f;
// What it costs on a plane that begins at a crease before which it lies.
constexpr float kCostBefore = 1.f;
// Shares of a superpixel that speak for a plane which it has beyond a crease:
// observed, or confirmed by other views.
constexpr float kMinShare = 0.2f;
// A region's plane is the one that ends if their depths are this close, in
// relative depths of one pixel of disparity: a region may have a copy of it.
constexpr float kMaxRegionGap = 4.f;

// Whether one may be a copy of the other (FindPlaneCopies), as far as the view
// tells: which of them begins at a crease is not known.
// Planes that differ by less than this in direction, as its cosine (3 degrees),
// and by kCopyTolerance in depth may be one.
constexpr double kMinCosine = 0.9986;

}  // namespace

CreaseLabels::CreaseLabels(const ObservedView& view,
                           const std::vector<ModelPlane>& planes,
                           const std::vector<BoundingCrease>& creases)
    : evidence_(*view.evidence),
      camera_(view.camera),
      planes_(planes),
      creases_(creases),
      rays_(MiddleRays(evidence_, view.camera.GetIntrinsics())),
      num_pixels_(CountPixels(evidence_)),
      is_cut_(rays_.size(), 0) {
  for (const BoundingCrease& crease : creases_) {
    std::vector<uint8_t>& is_beyond = is_beyond_.emplace_back();
    const Plane ending = ToCameraPlane(
        planes_[static_cast<size_t>(crease.plane)].plane, camera_);
    const Plane limit = ToCameraPlane(crease.limit, camera_);
    const bool is_seen = crease.limit.Height(camera_.Center()) > 0.0;
    for (size_t s = 0; s < rays_.size(); ++s) {
      // The ray meets what begins at the crease before what ends there.
      const float depth = limit.Depth(rays_[s]);
      is_beyond.push_back(is_seen && depth > 0.f &&
                          depth < ending.Depth(rays_[s]));
      if (is_beyond.back() != 0 && MayCutRegion(s, ending)) {
        is_cut_[s] = 1;
      }
    }
  }
}

bool CreaseLabels::MayCutRegion(size_t superpixel, const Plane& plane) const {
  int num_region = 0;
  int num_on = 0;
  for (int i = evidence_.first_observation[superpixel];
       i < evidence_.first_observation[superpixel + 1];
       ++i) {
    const auto number = static_cast<size_t>(i);
    if (evidence_.is_measured[number] != 0) {
      continue;
    }
    const RayDepth& sample = evidence_.observations[number].sample;
    const float depth = plane.Depth({sample.x, sample.y, 1.f});
    ++num_region;
    num_on += depth > 0.f &&
              std::abs(depth - sample.z) <=
                  kMaxRegionGap * sample.z *
                      evidence_.resolution.RelativeDepthError(sample.z);
  }
  return 2 * num_on >= num_region;
}

ViewEvidence CreaseLabels::WithoutRegionsBeyond() const {
  ViewEvidence result = evidence_;
  result.observations.clear();
  result.is_measured.clear();
  result.first_observation = {0};
  for (size_t s = 0; s < rays_.size(); ++s) {
    float confidence = 0.f;
    float kept = 0.f;
    for (int i = evidence_.first_observation[s];
         i < evidence_.first_observation[s + 1];
         ++i) {
      const auto number = static_cast<size_t>(i);
      const Observation& observation = evidence_.observations[number];
      confidence += observation.confidence;
      if (is_cut_[s] == 0 || evidence_.is_measured[number] != 0) {
        kept += observation.confidence;
        result.observations.push_back(observation);
        result.is_measured.push_back(evidence_.is_measured[number]);
      }
    }
    if (confidence > 0.f) {
      result.weights[s] *= kept / confidence;
    }
    result.first_observation.push_back(
        static_cast<int>(result.observations.size()));
  }
  return result;
}

std::vector<Image<uint8_t>> CreaseLabels::FindBeginnings(
    const std::vector<int>& numbers) const {
  std::vector<Image<uint8_t>> begins;
  for (const BoundingCrease& crease : creases_) {
    const WorldPlane& world = planes_[static_cast<size_t>(crease.beyond)].plane;
    const Plane beyond = ToCameraPlane(world, camera_);
    Image<uint8_t>& of_crease =
        begins.emplace_back(static_cast<int>(numbers.size()),
                            static_cast<int>(rays_.size()),
                            uint8_t{0});
    for (size_t k = 0; k < numbers.size(); ++k) {
      const WorldPlane& other = planes_[static_cast<size_t>(numbers[k])].plane;
      if (other.normal.dot(world.normal) < kMinCosine) {
        continue;
      }
      const Plane in_camera = ToCameraPlane(other, camera_);
      for (size_t s = 0; s < rays_.size(); ++s) {
        const float depth = beyond.Depth(rays_[s]);
        of_crease(static_cast<int>(k), static_cast<int>(s)) =
            depth > 0.f && std::abs(in_camera.Depth(rays_[s]) - depth) <=
                               kCopyTolerance * depth;
      }
    }
  }
  return begins;
}

void CreaseLabels::AddVotes(const std::vector<int>& numbers,
                            const Image<PlaneCost>& costs,
                            const LabelOptions& options,
                            Image<float>* votes) const {
  if (votes->Empty()) {
    *votes = Image<float>(costs.Width(), costs.Height(), 0.f);
  }
  const auto column_of = [&](int plane) {
    return static_cast<int>(
        std::lower_bound(numbers.begin(), numbers.end(), plane) -
        numbers.begin());
  };
  std::vector<Plane> in_camera;
  for (const int number : numbers) {
    in_camera.push_back(
        ToCameraPlane(planes_[static_cast<size_t>(number)].plane, camera_));
  }
  const std::vector<Image<uint8_t>> begins = FindBeginnings(numbers);
  Image<uint8_t> begins_somewhere(costs.Width(), costs.Height(), 0);
  for (const Image<uint8_t>& of_crease : begins) {
    std::transform(of_crease.begin(),
                   of_crease.end(),
                   begins_somewhere.begin(),
                   begins_somewhere.begin(),
                   [](uint8_t a, uint8_t b) { return std::max(a, b); });
  }
  // By column, where planes that begin at creases may be.
  std::map<int, std::vector<uint8_t>> beginning;
  for (size_t i = 0; i < creases_.size(); ++i) {
    const BoundingCrease& crease = creases_[i];
    const Plane limit = ToCameraPlane(crease.limit, camera_);
    for (size_t s = 0; s < rays_.size(); ++s) {
      const auto row = static_cast<int>(s);
      const float depth = limit.Depth(rays_[s]);
      for (int k = 0; k < costs.Width() && is_beyond_[i][s] != 0; ++k) {
        const PlaneCost& cost = costs(k, row);
        const auto column = static_cast<size_t>(k);
        // Another surface that begins at a crease may stand before this one.
        const float other = in_camera[column].Depth(rays_[s]);
        const bool may_be =
            begins[i](k, row) != 0 ||
            (begins_somewhere(k, row) != 0 && other > 0.f && other < depth);
        if (numbers[column] == crease.plane ||
            (!may_be && cost.explained < kMinShare &&
             cost.confirmed < kMinShare)) {
          (*votes)(k, row) += kCostBeyond * num_pixels_[s];
        }
      }
    }
    if (crease.is_new) {
      std::vector<uint8_t>& may_be = beginning[column_of(crease.beyond)];
      may_be.resize(rays_.size());
      std::transform(may_be.begin(),
                     may_be.end(),
                     is_beyond_[i].begin(),
                     may_be.begin(),
                     [](uint8_t a, uint8_t b) { return std::max(a, b); });
    }
  }
  for (const auto& [column, may_be] : beginning) {
    for (size_t s = 0; s < rays_.size(); ++s) {
      const float unobserved =
          std::max(num_pixels_[s] - evidence_.weights[s], 0.f);
      (*votes)(column, static_cast<int>(s)) +=
          may_be[s] != 0 ? -options.uncertainty_cost * unobserved
                         : kCostBefore * num_pixels_[s];
    }
  }
}

void CreaseLabels::MarkBounded(const std::vector<int>& labels,
                               std::vector<LabelEvidence>* evidence) const {
  for (size_t s = 0; s < is_cut_.size(); ++s) {
    if (is_cut_[s] != 0 && labels[s] < 0) {
      (*evidence)[s] = LabelEvidence::kBounded;
    }
  }
}

}  // namespace tsar
