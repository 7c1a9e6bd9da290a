// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/labeling/crease_distance.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

// The depth along each ray of the plane that begins at a crease, where the ray
// lies beyond that: it intersects the crease's limit before the plane that ends
// there. 0 elsewhere, and where the camera does not see the limit.
std::vector<float> DepthsBeyond(const BoundingCrease& crease,
                                const std::vector<ModelPlane>& planes,
                                const std::vector<Vec3f>& rays,
                                const Camera& camera) {
  std::vector<float> depths(rays.size(), 0.f);
  if (!(crease.limit.Height(camera.Center()) > 0.0)) {
    return depths;
  }
  const Plane ending = ToCameraPlane(planes[crease.plane].plane, camera);
  const Plane limit = ToCameraPlane(crease.limit, camera);
  const Plane beginning = ToCameraPlane(planes[crease.beyond].plane, camera);
  std::ranges::transform(rays, depths.begin(), [&](const Vec3f& ray) {
    const float depth = limit.Depth(ray);
    return depth > 0.f && depth < ending.Depth(ray)
               ? std::max(depth, beginning.Depth(ray))
               : 0.f;
  });
  return depths;
}

// By superpixel, beyond which creases its middle lies: equal numbers stand for
// equal sides of all.
std::vector<int> FindSides(const ObservedView& view,
                           const std::vector<ModelPlane>& planes,
                           const std::vector<BoundingCrease>& creases) {
  const std::vector<Vec3f> rays =
      MiddleRays(*view.evidence, view.camera.GetIntrinsics());
  std::vector<int> sides(rays.size(), 0);
  for (const BoundingCrease& crease : creases) {
    if (!crease.is_new) {
      continue;
    }
    const std::vector<float> depths =
        DepthsBeyond(crease, planes, rays, view.camera);
    std::map<std::pair<int, bool>, int> indices;
    for (size_t s = 0; s < rays.size(); ++s) {
      const auto index = static_cast<int>(indices.size());
      sides[s] =
          indices.try_emplace({sides[s], depths[s] > 0.f}, index).first->second;
    }
  }
  return sides;
}

// The creases in one view at which new planes begin.
class CreasesInView {
 public:
  CreasesInView(const ObservedView& view,
                const std::vector<ModelPlane>& planes,
                const std::vector<BoundingCrease>& creases)
      : intrinsics_(view.camera.GetIntrinsics()) {
    for (const BoundingCrease& crease : creases) {
      if (crease.is_new && crease.limit.Height(view.camera.Center()) > 0.0) {
        const Plane ending =
            ToCameraPlane(planes[crease.plane].plane, view.camera);
        const Plane beginning =
            ToCameraPlane(planes[crease.beyond].plane, view.camera);
        creases_.push_back(
            {ending, ToInverseDepth(ending), ToInverseDepth(beginning)});
      }
    }
  }

  // Whether a depth was measured next to a crease.
  bool AreNear(const RayDepth& sample) const {
    const Vec3f ray = {sample.x, sample.y, 1.f};
    return std::ranges::any_of(creases_, [&](const CreaseInView& crease) {
      const float depth = crease.ending.Depth(ray);
      return DistanceToCrease(crease.inverse_ending,
                              crease.inverse_beginning,
                              ray,
                              intrinsics_) < kReach &&
             std::abs(sample.z - depth) < kMaxGap * depth;
    });
  }

 private:
  struct CreaseInView {
    Plane ending;
    InverseDepthPlane inverse_ending;
    InverseDepthPlane inverse_beginning;
  };

  const Intrinsics intrinsics_;
  std::vector<CreaseInView> creases_;
};

}  // namespace

ViewEvidence CutAtCreases(const ObservedView& view,
                          const std::vector<ModelPlane>& planes,
                          const std::vector<BoundingCrease>& creases) {
  ViewEvidence evidence = *view.evidence;
  evidence.sides = FindSides(view, planes, creases);
  const CreasesInView in_view(view, planes, creases);
  for (size_t s = 0; s < evidence.weights.size(); ++s) {
    float before = 0.f;
    float after = 0.f;
    for (int i = evidence.first_observation[s];
         i < evidence.first_observation[s + 1];
         ++i) {
      Observation& observation = evidence.observations[i];
      before += observation.confidence;
      observation.confidence *=
          in_view.AreNear(observation.sample) ? kWeightAtCrease : 1.f;
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
      const auto num_far =
          std::count_if(first, last, [&](const RayDepth& sample) {
            return !in_view.AreNear(sample);
          });
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
        DepthsBeyond(crease, planes, rays, view.camera);
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
