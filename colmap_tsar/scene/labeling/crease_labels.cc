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
  // indices: of the columns in the model, ascending, including planes that
  // begin at creases.
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
      const Plane plane = ToCameraPlane(planes[indices[k]].plane, camera);
      for (int s = 0; s < depths_.Height(); ++s) {
        depths_(k, s) = plane.Depth(rays[s]);
      }
    }
    for (const BoundingCrease& crease : creases) {
      const int beyond = ColumnOf(crease.beyond);
      const auto [found, is_first] = is_along_.try_emplace(beyond);
      const Eigen::Vector3d& normal = planes[crease.beyond].plane.normal;
      for (int k = 0; k < depths_.Width() && is_first; ++k) {
        const bool is_along =
            planes[indices[k]].plane.normal.dot(normal) > kMinCopyCosine;
        found->second.push_back(is_along);
        for (int s = 0; s < depths_.Height() && is_along; ++s) {
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
    if (is_along_.at(beyond)[column] && IsClose(beyond, column, row)) {
      return true;
    }
    const float depth = depths_(column, row);
    return begins_(column, row) != 0 && depth > 0.f && depth < limit;
  }

 private:
  bool IsClose(int beyond, int column, int row) const {
    const float depth = depths_(beyond, row);
    return depth > 0.f &&
           std::abs(depths_(column, row) - depth) <= kCopyTolerance * depth;
  }

  const std::vector<int>& indices_;
  Image<float> depths_;
  Image<uint8_t> begins_;  // At any crease.
  // By column that begins at a crease, the columns with nearly the same normal.
  std::map<int, std::vector<bool>> is_along_;
};

// Where superpixels lie beyond a crease, the depth of the plane that begins
// there on the rays of their centers; 0 elsewhere.
std::vector<float> DepthsBeyond(const BoundingCrease& crease,
                                const std::vector<ModelPlane>& planes,
                                const std::vector<Vec3f>& rays,
                                const Camera& camera) {
  std::vector<float> depths(rays.size(), 0.f);
  if (!(crease.limit.Height(camera.Center()) > 0.0)) {
    return depths;
  }
  const Plane ending = ToCameraPlane(planes[crease.plane].plane, camera);
  const Plane beginning = ToCameraPlane(crease.limit, camera);
  for (size_t s = 0; s < rays.size(); ++s) {
    // The ray intersects the plane that begins at the crease before the one
    // that ends there.
    const float depth = beginning.Depth(rays[s]);
    if (depth > 0.f && depth < ending.Depth(rays[s])) {
      depths[s] = depth;
    }
  }
  return depths;
}

}  // namespace

void AddCreaseVotes(const ObservedView& view,
                    const std::vector<ModelPlane>& planes,
                    const std::vector<int>& indices,
                    const std::vector<BoundingCrease>& creases,
                    const Image<PlaneCost>& costs,
                    const LabelOptions& options,
                    Image<float>* votes) {
  const ViewEvidence& evidence = *view.evidence;
  const std::vector<Vec3f> rays =
      MiddleRays(evidence, view.camera.GetIntrinsics());
  const std::vector<float> num_pixels = CountPixels(evidence);
  const PlanesAtCreases at_creases(planes, indices, creases, rays, view.camera);
  // Whether a plane lies beyond at least one crease.
  Image<uint8_t> is_costly(costs.Width(), costs.Height(), 0);
  // By column: the superpixels in which planes that begin at creases may lie.
  std::map<int, std::vector<uint8_t>> beginning;
  for (const BoundingCrease& crease : creases) {
    const std::vector<float> limits =
        DepthsBeyond(crease, planes, rays, view.camera);
    for (int s = 0; s < costs.Height(); ++s) {
      for (int k = 0; k < costs.Width() && limits[s] > 0.f; ++k) {
        const PlaneCost& cost = costs(k, s);
        is_costly(k, s) |=
            indices[k] == crease.plane ||
            (cost.explained < kMinShare && cost.confirmed < kMinShare &&
             !at_creases.MayBeBeyond(crease, limits[s], k, s));
      }
    }
    if (crease.is_new) {
      std::vector<uint8_t>& may_be =
          beginning[at_creases.ColumnOf(crease.beyond)];
      may_be.resize(rays.size());
      for (size_t s = 0; s < rays.size(); ++s) {
        may_be[s] |= limits[s] > 0.f;
      }
    }
  }
  if (votes->Empty()) {
    *votes = Image<float>(costs.Width(), costs.Height(), 0.f);
  }
  for (int s = 0; s < costs.Height(); ++s) {
    for (int k = 0; k < costs.Width(); ++k) {
      (*votes)(k, s) +=
          is_costly(k, s) != 0 ? kCostBeyond * num_pixels[s] : 0.f;
    }
    for (const auto& [k, may_be] : beginning) {
      const float unobserved =
          std::max(num_pixels[s] - evidence.weights[s], 0.f);
      (*votes)(k, s) += may_be[s] != 0 ? -options.uncertainty_cost * unobserved
                                       : kCostBefore * num_pixels[s];
    }
  }
}

}  // namespace tsar
