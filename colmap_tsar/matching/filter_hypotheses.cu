// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/reprojection.cuh"

#include <cmath>

namespace tsar {
namespace {

struct FilterKernel {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;
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

  TSAR_HD bool IsMatch(float cost) const {
    return cost != kUndefinedCost && cost <= 1.f - options.min_ncc;
  }

  TSAR_HD float operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    return IsConfirmed(x, y, depth) ? depth : 0.f;
  }

  // Whether enough sources are consistent and match.
  TSAR_HD bool IsConfirmed(int x, int y, float depth) const {
    if (!(depth > 0.f)) {
      return false;
    }
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth, reference.normal(x, y));
    if (!plane.Valid()) {
      return false;
    }
    const Vec3f point = ray * depth;
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    int num_confirming = 0;
    for (int s = 0; s < num_sources; ++s) {
      if (IsConsistent(sources[s], x, y, point) &&
          IsMatch(PatchCost(patch, reference.intrinsics, sources[s], plane))) {
        ++num_confirming;
      }
    }
    return num_confirming >= options.min_num_consistent;
  }
};

}  // namespace

DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
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
                                       options,
                                       max_cos_angle});
}

}  // namespace tsar
