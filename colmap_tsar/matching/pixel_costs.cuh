// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_sampling.cuh"
#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/matching/views.h"

#include <cmath>

namespace tsar {

// The cost of a window that a view does not see, or sees without texture.
constexpr float kMaxCost = 2.f;

// The costs of planes at one pixel.
struct PixelCosts {
  const ReferenceView& reference;
  const PatchMatchOptions& options;
  const ReferencePatch& patch;
  Vec3f ray;
  Plane prior;  // May be invalid.

  // 1 - NCC in one view.
  TSAR_HD float Photometric(const SourceView& source,
                            const Plane& plane) const {
    if (!patch.HasTexture()) {
      return kMaxCost;
    }
    const PlaneHomography homography(
        reference.intrinsics, source.intrinsics, source.from_reference, plane);
    const float cost = PatchCost(patch, homography, source.gray);
    return cost == kUndefinedCost ? kMaxCost : cost;
  }

  // The geometric term of the view's depth map.
  TSAR_HD float Geometric(const SourceView& source, const Plane& plane) const {
    if (source.depth.width == 0) {
      return 0.f;
    }
    float error = options.max_geometric_error;
    SeenThroughSource seen;
    if (LookThroughSource(
            reference.intrinsics, source, ray * plane.Depth(ray), &seen)) {
      const float dx = seen.x - patch.center_x;
      const float dy = seen.y - patch.center_y;
      error = fminf(error, sqrtf(dx * dx + dy * dy));
    }
    return options.geometric_weight * error;
  }

  // The term for the plane's deviation from the prior.
  TSAR_HD float OffPrior(const Plane& plane) const {
    const float expected = prior.Valid() ? prior.Depth(ray) : 0.f;
    if (!(expected > 0.f)) {
      return 0.f;
    }
    const float sigmas =
        (plane.Depth(ray) - expected) / (options.prior_sigma * expected);
    return options.prior_weight * fminf(sigmas * sigmas, 1.f);
  }
};

// Whether the plane's depth at the pixel lies between the bounds.
TSAR_HD inline bool IsUsable(const Plane& plane,
                             const Vec3f& ray,
                             const PatchMatchOptions& options) {
  const DepthBounds bounds{options.depth_min, options.depth_max};
  return plane.Valid() && bounds.Contains(plane.Depth(ray));
}

}  // namespace tsar
