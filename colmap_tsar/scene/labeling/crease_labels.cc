// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/crease_labels.h"

#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>

namespace tsar {
namespace {

// The cost of a pixel on a plane that ends before it: more than pairwise costs
// can outweigh.
constexpr float kCostBeyond = 0.3f;
// The cost of a pixel on a plane that begins at a crease, where it does not lie
// beyond that.
constexpr float kCostBefore = 1.f;
// The share of a superpixel, observed or confirmed by other views, that
// supports a plane beyond a crease.
constexpr float kMinShare = 0.2f;

// The depths of the planes that a view may be labeled with (columns) at the
// centers of its superpixels (rows), and where each coincides with one that
// begins at a crease.
class PlanesAtCreases {
 public:
  // numbers: indices of the columns in the model, ascending, including planes
  // that begin at creases.
  PlanesAtCreases(const std::vector<ModelPlane>& planes,
                  const std::vector<int>& indices,
                  const std::vector<BoundingCrease>& creases,
                  const std::vector<Vec3f>& rays,
                  const Camera& camera)
      : indices_(indices),
        depths_(static_cast<int>(indices.size()),
                static_cast<int>(rays.size())),
        begins_(depths_.Width(), depths_.Height(), 0) {
    for (int k = 0; k < depths_.Width(); ++k) {
      const Plane plane = ToCameraPlane(PlaneOf(planes, k), camera);
      for (int s = 0; s < depths_.Height(); ++s) {
        depths_(k, s) = plane.Depth(rays[static_cast<size_t>(s)]);
      }
    }
    for (const BoundingCrease& crease : creases) {
      const int beyond = ColumnOf(crease.beyond);
      const auto [found, is_first] = is_along_.try_emplace(beyond);
      for (int k = 0; k < depths_.Width() && is_first; ++k) {
        found->second.push_back(
            PlaneOf(planes, k).normal.dot(PlaneOf(planes, beyond).normal) >
            kMinCopyCosine);
        for (int s = 0; s < depths_.Height() && found->second.back() != 0;
             ++s) {
          begins_(k, s) |= IsClose(beyond, k, s);
        }
      }
    }
  }

  int ColumnOf(int plane) const {
    return static_cast<int>(
        std::lower_bound(indices_.begin(), indices_.end(), plane) -
        indices_.begin());
  }

  // Whether the plane coincides there with the one that begins at the crease,
  // or with one that begins at another crease and lies in front of it. limit:
  // the depth of the plane that begins at the crease.
  bool MayBeBeyond(const BoundingCrease& crease,
                   float limit,
                   int column,
                   int row) const {
    const int beyond = ColumnOf(crease.beyond);
    if (is_along_.at(beyond)[static_cast<size_t>(column)] != 0 &&
        IsClose(beyond, column, row)) {
      return true;
    }
    const float depth = depths_(column, row);
    return begins_(column, row) != 0 && depth > 0.f && depth < limit;
  }

 private:
  const WorldPlane& PlaneOf(const std::vector<ModelPlane>& planes,
                            int column) const {
    return planes[static_cast<size_t>(indices_[static_cast<size_t>(column)])]
        .plane;
  }

  bool IsClose(int beyond, int column, int row) const {
    const float depth = depths_(beyond, row);
    return depth > 0.f &&
           std::abs(depths_(column, row) - depth) <= kCopyTolerance * depth;
  }

  const std::vector<int>& indices_;
  Image<float> depths_;
  Image<uint8_t> begins_;  // At any crease.
  // By column that begins at a crease, the columns with nearly the same normal.
  std::map<int, std::vector<uint8_t>> is_along_;
};

}  // namespace

CreaseLabels::CreaseLabels(const ObservedView& view,
                           const std::vector<ModelPlane>& planes,
                           const std::vector<BoundingCrease>& creases)
    : evidence_(*view.evidence),
      camera_(view.camera),
      planes_(planes),
      creases_(creases),
      rays_(MiddleRays(evidence_, view.camera.GetIntrinsics())),
      num_pixels_(CountPixels(evidence_)) {
  for (const BoundingCrease& crease : creases_) {
    std::vector<float>& limits = limits_.emplace_back();
    const Plane ending = ToCameraPlane(
        planes_[static_cast<size_t>(crease.plane)].plane, camera_);
    const Plane limit = ToCameraPlane(crease.limit, camera_);
    const bool is_seen = crease.limit.Height(camera_.Center()) > 0.0;
    for (size_t s = 0; s < rays_.size(); ++s) {
      // The ray intersects the plane that begins at the crease before the one
      // that ends there.
      const float depth = limit.Depth(rays_[s]);
      const bool is_beyond =
          is_seen && depth > 0.f && depth < ending.Depth(rays_[s]);
      limits.push_back(is_beyond ? depth : 0.f);
    }
  }
}

void CreaseLabels::AddVotes(const std::vector<int>& indices,
                            const Image<PlaneCost>& costs,
                            const LabelOptions& options,
                            Image<float>* votes) const {
  if (votes->Empty()) {
    *votes = Image<float>(costs.Width(), costs.Height(), 0.f);
  }
  const PlanesAtCreases planes(planes_, indices, creases_, rays_, camera_);
  // Whether a plane lies beyond at least one crease.
  Image<uint8_t> is_costly(costs.Width(), costs.Height(), 0);
  // By column: the superpixels in which planes that begin at creases may lie.
  std::map<int, std::vector<uint8_t>> beginning;
  for (size_t i = 0; i < creases_.size(); ++i) {
    const BoundingCrease& crease = creases_[i];
    for (size_t s = 0; s < rays_.size(); ++s) {
      const float limit = limits_[i][s];
      if (limit == 0.f) {
        continue;
      }
      const auto row = static_cast<int>(s);
      for (int k = 0; k < costs.Width(); ++k) {
        const PlaneCost& cost = costs(k, row);
        is_costly(k, row) |=
            indices[static_cast<size_t>(k)] == crease.plane ||
            (cost.explained < kMinShare && cost.confirmed < kMinShare &&
             !planes.MayBeBeyond(crease, limit, k, row));
      }
    }
    if (crease.is_new) {
      std::vector<uint8_t>& may_be = beginning[planes.ColumnOf(crease.beyond)];
      may_be.resize(rays_.size());
      for (size_t s = 0; s < rays_.size(); ++s) {
        may_be[s] |= limits_[i][s] > 0.f;
      }
    }
  }
  for (int k = 0; k < costs.Width(); ++k) {
    for (size_t s = 0; s < rays_.size(); ++s) {
      const auto row = static_cast<int>(s);
      (*votes)(k, row) +=
          is_costly(k, row) != 0 ? kCostBeyond * num_pixels_[s] : 0.f;
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

}  // namespace tsar
