// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include "colmap_tsar/device/parallel_for.h"
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
  ImageView<float> filtered;

  TSAR_HD void operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    filtered(x, y) = 0.f;
    if (!(depth > 0.f)) {
      return;
    }
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth, reference.normal(x, y));
    if (!plane.Valid()) {
      return;
    }
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    int num_consistent = 0;
    for (int s = 0; s < num_sources; ++s) {
      num_consistent += IsConsistent(sources[s], patch, plane, ray * depth);
    }
    if (num_consistent >= options.min_num_consistent) {
      filtered(x, y) = depth;
    }
  }

  TSAR_HD int IsConsistent(const SourceView& source,
                           const ReferencePatch& patch,
                           const Plane& plane,
                           const Vec3f& point) const {
    SeenThroughSource seen;
    if (!LookThroughSource(reference.intrinsics, source, point, &seen)) {
      return 0;
    }
    const float dx = seen.x - patch.center_x;
    const float dy = seen.y - patch.center_y;
    if (!(dx * dx + dy * dy <= options.geom_consistency_max_cost *
                                   options.geom_consistency_max_cost)) {
      return 0;
    }
    // From the point to the cameras.
    const RelativePose& pose = source.from_reference;
    const Vec3f to_source =
        -TransposeTimes(pose.rotation, pose.translation) - point;
    if (!(Dot(-point, to_source) <=
          max_cos_angle * Norm(point) * Norm(to_source))) {
      return 0;
    }
    const float cost = PatchCost(patch,
                                 PlaneHomography(reference.intrinsics,
                                                 source.intrinsics,
                                                 source.from_reference,
                                                 plane),
                                 source.gray);
    return cost != kUndefinedCost && cost <= 1.f - options.min_ncc ? 1 : 0;
  }
};

}  // namespace

DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
                                    const HypothesisFilterOptions& options,
                                    Device& device) {
  DeviceImage<float> filtered(
      device, reference.depth.width, reference.depth.height);
  ParallelFor(device,
              filtered.Width(),
              filtered.Height(),
              FilterKernel{reference,
                           sources.Data(),
                           static_cast<int>(sources.Size()),
                           options,
                           std::cos(options.min_triangulation_angle *
                                    3.14159265f / 180.f),
                           filtered.View()});
  return filtered;
}

}  // namespace tsar
