// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/distinct_matches.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/consistency.cuh"

#include <cmath>

namespace tsar {
namespace {

struct DistinctMatchKernel {
  ReferenceView reference;
  SourceView source;
  HypothesisFilterOptions options;
  float max_cos_angle;
  ImageView<uint8_t> num_matches;

  TSAR_HD void operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    if (num_matches(x, y) >= options.min_num_consistent || !(depth > 0.f)) {
      return;
    }
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    if (IsConsistentWith(reference.intrinsics,
                         source,
                         x,
                         y,
                         ray * depth,
                         options.geom_consistency_max_cost,
                         max_cos_angle) &&
        MatchesDistinctly(x, y, ray, depth)) {
      ++num_matches(x, y);
    }
  }

  TSAR_HD bool MatchesDistinctly(int x,
                                 int y,
                                 const Vec3f& ray,
                                 float depth) const {
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    const Vec3f normal = reference.normal(x, y);
    const float cost = Cost(patch, ray, depth, normal);
    if (cost == kUndefinedCost || !(cost <= 1.f - options.min_ncc)) {
      return false;
    }
    constexpr int kNumSteps = 2;  // Steps to either side.
    constexpr float kStep = 2.f;  // Pixels per step.
    const float change = ChangePerPixel(ray, depth);
    for (int step = -kNumSteps; step <= kNumSteps; ++step) {
      const float factor = 1.f + static_cast<float>(step) * kStep * change;
      if (step == 0 || !(factor > 0.f)) {
        continue;
      }
      const float cost_beside = Cost(patch, ray, depth / factor, normal);
      if (cost_beside != kUndefinedCost && !(cost < cost_beside)) {
        return false;
      }
    }
    return true;
  }

  TSAR_HD float Cost(const ReferencePatch& patch,
                     const Vec3f& ray,
                     float depth,
                     const Vec3f& normal) const {
    const Plane plane = Plane::FromPoint(ray, depth, normal);
    return plane.Valid() ? PatchCost(patch,
                                     PlaneHomography(reference.intrinsics,
                                                     source.intrinsics,
                                                     source.from_reference,
                                                     plane),
                                     source.gray)
                         : kUndefinedCost;
  }

  // The relative change of inverse depth that moves the point by one pixel in
  // the source.
  TSAR_HD float ChangePerPixel(const Vec3f& ray, float depth) const {
    constexpr float kChange = 0.01f;
    float x = 0.f;
    float y = 0.f;
    float moved_x = 0.f;
    float moved_y = 0.f;
    const RelativePose& pose = source.from_reference;
    source.intrinsics.Project(pose * (ray * depth), &x, &y);
    source.intrinsics.Project(
        pose * (ray * (depth / (1.f + kChange))), &moved_x, &moved_y);
    const float dx = moved_x - x;
    const float dy = moved_y - y;
    // The clamp avoids a division by 0 for a zero triangulation angle.
    return kChange / fmaxf(sqrtf(dx * dx + dy * dy), kChange);
  }
};

}  // namespace

void AddDistinctMatches(const ReferenceView& reference,
                        const SourceView& source,
                        const HypothesisFilterOptions& options,
                        ImageView<uint8_t> num_matches,
                        Device& device) {
  ParallelFor(device,
              num_matches.width,
              num_matches.height,
              DistinctMatchKernel{reference,
                                  source,
                                  options,
                                  std::cos(options.min_triangulation_angle *
                                           3.14159265f / 180.f),
                                  num_matches});
}

}  // namespace tsar
