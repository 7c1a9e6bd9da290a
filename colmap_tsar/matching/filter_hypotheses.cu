// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/view/denoise/window_variance.h"

#include <cmath>

namespace tsar {
namespace {

struct FilterKernel {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;
  ImageView<const Plane> prior;  // May be empty.
  HypothesisFilterOptions options;
  float max_cos_angle;

  // Whether the depth map of the source reprojects the point to the pixel.
  TSAR_HD bool IsConsistent(const SourceView& source,
                            int x,
                            int y,
                            const Vec3f& point) const {
    return IsConsistentWith(reference.intrinsics,
                            source,
                            x,
                            y,
                            point,
                            options.geom_consistency_max_cost,
                            max_cos_angle);
  }

  // patch: that of the pixel; plane: may be invalid.
  TSAR_HD float Cost(const SourceView& source,
                     const ReferencePatch& patch,
                     const Plane& plane) const {
    return plane.Valid() ? PatchCost(patch, reference.intrinsics, source, plane)
                         : kUndefinedCost;
  }

  TSAR_HD bool IsMatch(float cost) const {
    return cost != kUndefinedCost && cost <= 1.f - options.min_ncc;
  }

  TSAR_HD float operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    const bool follows = FollowsPrior(x, y, ray, depth);
    return IsConfirmed(x, y, ray, depth, !follows) ? depth : 0.f;
  }

  TSAR_HD bool FollowsPrior(int x, int y, const Vec3f& ray, float depth) const {
    if (prior.Empty() || !prior(x, y).Valid()) {
      return false;
    }
    const float expected = prior(x, y).Depth(ray);
    return expected > 0.f &&
           fabsf(depth - expected) <= options.prior_tolerance * expected &&
           OwnTexture(reference.gray, x, y) < options.min_distinct_texture;
  }

  TSAR_HD bool IsConfirmed(
      int x, int y, const Vec3f& ray, float depth, bool must_match) const {
    if (!(depth > 0.f)) {
      return false;
    }
    const Plane plane = Plane::FromPoint(ray, depth, reference.normal(x, y));
    if (!plane.Valid()) {
      return false;
    }
    const Vec3f point = ray * depth;
    if (!must_match) {
      return AreEnoughConsistent(x, y, point, plane, nullptr);
    }
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    return AreEnoughConsistent(x, y, point, plane, &patch);
  }

  // patch: the window that the sources must match as well; may be null.
  TSAR_HD bool AreEnoughConsistent(int x,
                                   int y,
                                   const Vec3f& point,
                                   const Plane& plane,
                                   const ReferencePatch* patch) const {
    int num_consistent = 0;
    for (int s = 0; s < num_sources; ++s) {
      if (IsConsistent(sources[s], x, y, point) &&
          (patch == nullptr || IsMatch(Cost(sources[s], *patch, plane)))) {
        ++num_consistent;
      }
    }
    return num_consistent >= options.min_num_consistent;
  }
};

}  // namespace

DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
                                    ImageView<const Plane> prior,
                                    const HypothesisFilterOptions& options,
                                    Device& device) {
  const float max_cos_angle =
      std::cos(options.min_triangulation_angle * 3.14159265f / 180.f);
  return MapPixels<float>(device,
                          reference.depth.width,
                          reference.depth.height,
                          FilterKernel{reference,
                                       sources.Data(),
                                       static_cast<int>(sources.Size()),
                                       prior,
                                       options,
                                       max_cos_angle});
}

}  // namespace tsar
