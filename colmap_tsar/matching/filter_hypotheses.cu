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

  TSAR_HD float operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth, reference.normal(x, y));
    if (!(depth > 0.f) || !plane.Valid()) {
      return 0.f;
    }
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    int num_confirming = 0;
    for (int s = 0; s < num_sources; ++s) {
      if (IsConsistent(sources[s], x, y, ray * depth) &&
          IsMatch(sources[s], patch, plane)) {
        ++num_confirming;
      }
    }
    return num_confirming >= options.min_num_consistent ? depth : 0.f;
  }

  // Whether the point has a reprojection error and a triangulation angle within
  // the limits.
  TSAR_HD bool IsConsistent(const SourceView& source,
                            int x,
                            int y,
                            const Vec3f& point) const {
    SeenThroughSource seen;
    if (!LookThroughSource(reference.intrinsics, source, point, &seen) ||
        !seen.IsWithin(options.geom_consistency_max_cost, x, y)) {
      return false;
    }
    // Directions from the point to the cameras.
    const RelativePose& pose = source.from_reference;
    const Vec3f to_source =
        -TransposeTimes(pose.rotation, pose.translation) - point;
    return Dot(-point, to_source) <=
           max_cos_angle * Norm(point) * Norm(to_source);
  }

  TSAR_HD bool IsMatch(const SourceView& source,
                       const ReferencePatch& patch,
                       const Plane& plane) const {
    const float cost = PatchCost(patch, reference.intrinsics, source, plane);
    return cost != kUndefinedCost && cost <= 1.f - options.min_ncc;
  }
};

}  // namespace

DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const SourceViews& sources,
                                    const HypothesisFilterOptions& options,
                                    Device& device) {
  const float max_cos_angle =
      std::cos(options.min_triangulation_angle * 3.14159265f / 180.f);
  return MapPixels<float>(
      device,
      reference.depth.width,
      reference.depth.height,
      FilterKernel{
          reference, sources.Data(), sources.Size(), options, max_cos_angle});
}

}  // namespace tsar
