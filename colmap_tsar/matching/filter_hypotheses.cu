// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/reprojection.cuh"
#include "colmap_tsar/view/denoise/window_variance.h"

#include <cmath>

namespace tsar {
namespace {

// The tests of a pixel's hypothesis against a source.
struct SourceTest {
  ReferenceView reference;
  HypothesisFilterOptions options;
  float max_cos_angle;

  SourceTest(const ReferenceView& view,
             const HypothesisFilterOptions& filter_options)
      : reference(view),
        options(filter_options),
        max_cos_angle(
            std::cos(options.min_triangulation_angle * 3.14159265f / 180.f)) {}

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
};

struct FilterKernel : SourceTest {
  const SourceView* sources;
  int num_sources;
  ImageView<const Plane> prior;  // May be empty.

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

struct DistinctMatchKernel : SourceTest {
  SourceView source;
  ImageView<uint8_t> num_matches;

  TSAR_HD void operator()(int x, int y) const {
    const float depth = reference.depth(x, y);
    if (num_matches(x, y) >= options.min_num_consistent || !(depth > 0.f)) {
      return;
    }
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    if (IsConsistent(source, x, y, ray * depth) &&
        MatchesDistinctly(x, y, ray, depth)) {
      ++num_matches(x, y);
    }
  }

  TSAR_HD bool MatchesDistinctly(int x,
                                 int y,
                                 const Vec3f& ray,
                                 float depth) const {
    const ReferencePatch patch(reference.gray, x, y, options.window_radius);
    const auto cost_at = [&](float z) {
      return Cost(
          source, patch, Plane::FromPoint(ray, z, reference.normal(x, y)));
    };
    const float cost = cost_at(depth);
    if (!IsMatch(cost)) {
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
      const float cost_beside = cost_at(depth / factor);
      if (cost_beside != kUndefinedCost && !(cost < cost_beside)) {
        return false;
      }
    }
    return true;
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

DeviceImage<float> FilterHypotheses(const ReferenceView& reference,
                                    const Buffer<SourceView>& sources,
                                    ImageView<const Plane> prior,
                                    const HypothesisFilterOptions& options,
                                    Device& device) {
  return MapPixels<float>(device,
                          reference.depth.width,
                          reference.depth.height,
                          FilterKernel{{reference, options},
                                       sources.Data(),
                                       static_cast<int>(sources.Size()),
                                       prior});
}

void AddDistinctMatches(const ReferenceView& reference,
                        const SourceView& source,
                        const HypothesisFilterOptions& options,
                        ImageView<uint8_t> num_matches,
                        Device& device) {
  ParallelFor(device,
              num_matches.width,
              num_matches.height,
              DistinctMatchKernel{{reference, options}, source, num_matches});
}

}  // namespace tsar
