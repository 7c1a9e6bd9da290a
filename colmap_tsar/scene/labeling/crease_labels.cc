// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <algorithm>
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

  bool is_seen;
  Plane ending;
  Plane limit;
  Plane beginning;
};

}  // namespace

std::vector<int> FindSidesOfCreases(
    const ObservedView& view,
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
        CreaseInView(crease, planes, view.camera).DepthsBeyond(rays);
    std::map<std::pair<int, bool>, int> indices;
    for (size_t s = 0; s < rays.size(); ++s) {
      const auto index = static_cast<int>(indices.size());
      sides[s] =
          indices.try_emplace({sides[s], depths[s] > 0.f}, index).first->second;
    }
  }
  return sides;
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
