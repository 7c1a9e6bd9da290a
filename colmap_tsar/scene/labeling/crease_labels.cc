// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/labeling/crease_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>

namespace tsar {
namespace {

// The cost of a pixel on a plane that another one hides there: more than
// pairwise costs can outweigh.
constexpr float kCostOfHidden = 0.3f;
// The cost of a pixel on a plane that begins at a crease, where it does not lie
// beyond that.
constexpr float kCostBefore = 1.f;
// The largest uncertainty of a plane beyond the crease at which it begins.
constexpr float kMaxUncertainty = 0.5f;
// Measurements within this distance of a crease, in pixels of the raster, and
// of its depth, as a share of that, keep this share of their weight.
constexpr float kReach = 8.f;
constexpr float kMaxGap = 0.1f;
constexpr float kWeightAtCrease = 0.05f;

// A crease in the camera's frame.
struct CreaseInView {
  CreaseInView(const BoundingCrease& crease,
               const std::vector<ModelPlane>& planes,
               const Camera& camera)
      : is_seen(crease.limit.Height(camera.Center()) > 0.0),
        ending(ToCameraPlane(planes[crease.plane].plane, camera)),
        limit(ToCameraPlane(crease.limit, camera)),
        beginning(ToCameraPlane(planes[crease.beyond].plane, camera)) {}

  // The depth along each ray of the plane that begins at the crease, where the
  // ray lies beyond that: it intersects the crease's limit before the plane
  // that ends there. 0 elsewhere, and where the camera does not see the limit.
  std::vector<float> DepthsBeyond(const std::vector<Vec3f>& rays) const {
    std::vector<float> depths(rays.size(), 0.f);
    for (size_t i = 0; is_seen && i < rays.size(); ++i) {
      const float depth = limit.Depth(rays[i]);
      depths[i] = depth > 0.f && depth < ending.Depth(rays[i])
                      ? std::max(depth, beginning.Depth(rays[i]))
                      : 0.f;
    }
    return depths;
  }

  // Whether a depth was measured next to the crease.
  bool IsNear(const RayDepth& sample, const Intrinsics& intrinsics) const {
    const Vec3f ray = {sample.x, sample.y, 1.f};
    const float depth = ending.Depth(ray);
    return DistanceToCrease(ToInverseDepth(ending),
                            ToInverseDepth(beginning),
                            ray,
                            intrinsics) < kReach &&
           std::abs(sample.z - depth) < kMaxGap * depth;
  }

  bool is_seen;
  Plane ending;
  Plane limit;
  Plane beginning;
};

// By superpixel, beyond which creases its middle lies: equal numbers stand for
// equal sides of all.
std::vector<int> FindSides(const ObservedView& view,
                           const std::vector<CreaseInView>& creases) {
  const std::vector<Vec3f> rays =
      MiddleRays(*view.evidence, view.camera.GetIntrinsics());
  std::vector<int> sides(rays.size(), 0);
  for (const CreaseInView& crease : creases) {
    const std::vector<float> depths = crease.DepthsBeyond(rays);
    std::map<std::pair<int, bool>, int> indices;
    for (size_t s = 0; s < rays.size(); ++s) {
      const auto index = static_cast<int>(indices.size());
      sides[s] =
          indices.try_emplace({sides[s], depths[s] > 0.f}, index).first->second;
    }
  }
  return sides;
}

}  // namespace

ViewEvidence CutAtCreases(const ObservedView& view,
                          const std::vector<ModelPlane>& planes,
                          const std::vector<BoundingCrease>& creases) {
  std::vector<CreaseInView> in_view;  // Of those at which new planes begin.
  for (const BoundingCrease& crease : creases) {
    const CreaseInView of_view(crease, planes, view.camera);
    if (crease.is_new && of_view.is_seen) {
      in_view.push_back(of_view);
    }
  }
  const Intrinsics intrinsics = view.camera.GetIntrinsics();
  const auto is_near = [&](const RayDepth& sample) {
    return std::ranges::any_of(in_view, [&](const CreaseInView& crease) {
      return crease.IsNear(sample, intrinsics);
    });
  };
  ViewEvidence evidence = *view.evidence;
  evidence.sides = FindSides(view, in_view);
  for (size_t s = 0; s < evidence.weights.size(); ++s) {
    float before = 0.f;
    float after = 0.f;
    for (int i = evidence.first_observation[s];
         i < evidence.first_observation[s + 1];
         ++i) {
      Observation& observation = evidence.observations[i];
      before += observation.confidence;
      observation.confidence *=
          is_near(observation.sample) ? kWeightAtCrease : 1.f;
      after += observation.confidence;
    }
    evidence.weights[s] *= before > 0.f ? after / before : 1.f;
    if (evidence.first_confirmed.empty()) {
      continue;
    }
    const auto first = evidence.confirmed.begin() + evidence.first_confirmed[s];
    const auto last =
        evidence.confirmed.begin() + evidence.first_confirmed[s + 1];
    if (first != last) {
      const auto num_far = std::count_if(first, last, std::not_fn(is_near));
      evidence.confirmed_pixels[s] = static_cast<int>(
          evidence.confirmed_pixels[s] * num_far / (last - first));
    }
  }
  return evidence;
}

void AddCreaseVotes(const ObservedView& view,
                    const std::vector<ModelPlane>& planes,
                    const std::vector<int>& indices,
                    const std::vector<BoundingCrease>& creases,
                    const LabelOptions& options,
                    Image<PlaneCost>* costs,
                    Image<float>* votes) {
  const ViewEvidence& evidence = *view.evidence;
  const std::vector<Vec3f> rays =
      MiddleRays(evidence, view.camera.GetIntrinsics());
  const std::vector<float> num_pixels = CountPixels(evidence);
  // By superpixel, the depth of the nearest plane that begins at a crease
  // before it, and by the column of such a plane, where it may lie.
  std::vector<float> limits(rays.size(),
                            std::numeric_limits<float>::infinity());
  std::map<int, std::vector<uint8_t>> may_begin;
  for (const BoundingCrease& crease : creases) {
    const std::vector<float> depths =
        CreaseInView(crease, planes, view.camera).DepthsBeyond(rays);
    const auto column = std::ranges::lower_bound(indices, crease.beyond);
    std::vector<uint8_t>* may_be =
        crease.is_new ? &may_begin[static_cast<int>(column - indices.begin())]
                      : nullptr;
    for (size_t s = 0; s < rays.size(); ++s) {
      if (depths[s] > 0.f) {
        limits[s] = std::min(limits[s], (1.f + kCopyTolerance) * depths[s]);
      }
      if (may_be != nullptr) {
        may_be->resize(rays.size(), 0);
        (*may_be)[s] |= depths[s] > 0.f ? 1 : 0;
      }
    }
  }
  if (votes->Empty()) {
    *votes = Image<float>(costs->Width(), costs->Height(), 0.f);
  }
  std::vector<Plane> in_view;
  for (const int index : indices) {
    in_view.push_back(ToCameraPlane(planes[index].plane, view.camera));
  }
  for (int s = 0; s < costs->Height(); ++s) {
    for (int k = 0; k < costs->Width(); ++k) {
      (*votes)(k, s) += in_view[k].Depth(rays[s]) > limits[s]
                            ? kCostOfHidden * num_pixels[s]
                            : 0.f;
    }
    const float unobserved = std::max(num_pixels[s] - evidence.weights[s], 0.f);
    for (const auto& [k, may_be] : may_begin) {
      if (may_be[s] == 0) {
        (*votes)(k, s) += kCostBefore * num_pixels[s];
        continue;
      }
      (*votes)(k, s) -= options.uncertainty_cost * unobserved;
      float& uncertainty = (*costs)(k, s).uncertainty;
      uncertainty = std::min(uncertainty, kMaxUncertainty);
    }
  }
}

}  // namespace tsar
