// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/matching_cost.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"

namespace tsar {
namespace {

struct MatchingCostKernel {
  ReferenceView reference;
  const SourceView* sources;
  int num_sources;
  ImageView<float> min_cost;
  ImageView<float> second_cost;
  ImageView<float> left_right_difference;

  TSAR_HD void operator()(int x, int y) const {
    float best = kUndefinedCost;
    float second = kUndefinedCost;
    float difference = kUndefinedCost;
    const float depth = reference.depth(x, y);
    const Vec3f normal = reference.normal(x, y);
    const Vec3f ray = reference.intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth, normal);
    if (depth > 0.f && plane.Valid()) {
      const ReferencePatch patch(reference.gray, x, y);
      int best_source = -1;
      if (patch.HasTexture()) {
        for (int s = 0; s < num_sources; ++s) {
          const float cost =
              PatchCost(patch, reference.intrinsics, sources[s], plane);
          if (cost == kUndefinedCost) {
            continue;
          }
          if (best_source < 0 || cost < best) {
            second = best;
            best = cost;
            best_source = s;
          } else if (second == kUndefinedCost || cost < second) {
            second = cost;
          }
        }
      }
      if (best_source >= 0) {
        difference =
            LeftRightDifference(sources[best_source], ray * depth, plane, best);
      }
    }
    min_cost(x, y) = best;
    second_cost(x, y) = second;
    left_right_difference(x, y) = difference;
  }

  TSAR_HD float LeftRightDifference(const SourceView& source,
                                    const Vec3f& point,
                                    const Plane& plane,
                                    float cost) const {
    const RelativePose& pose = source.from_reference;
    const Vec3f source_point = pose * point;
    float x = 0.f;
    float y = 0.f;
    source.intrinsics.Project(source_point, &x, &y);
    Plane source_plane;
    source_plane.normal = pose.rotation * plane.normal;
    source_plane.offset =
        plane.offset - Dot(source_plane.normal, pose.translation);
    if (!source_plane.Valid()) {
      return 1.f;
    }
    RelativePose back;
    const Mat3f& r = pose.rotation;
    back.rotation.row0 = {r.row0.x, r.row1.x, r.row2.x};
    back.rotation.row1 = {r.row0.y, r.row1.y, r.row2.y};
    back.rotation.row2 = {r.row0.z, r.row1.z, r.row2.z};
    back.translation = -TransposeTimes(r, pose.translation);
    const ReferencePatch patch(source.gray, x, y);
    const PlaneHomography homography(
        source.intrinsics, reference.intrinsics, back, source_plane);
    const float back_cost = PatchCost(patch, homography, reference.gray);
    return back_cost == kUndefinedCost ? 1.f
                                       : fminf(fabsf(cost - back_cost), 1.f);
  }
};

}  // namespace

MatchingCosts ComputeMatchingCosts(const ReferenceView& reference,
                                   const SourceViews& sources,
                                   Device& device) {
  const int width = reference.depth.width;
  const int height = reference.depth.height;
  MatchingCosts costs{DeviceImage<float>(device, width, height),
                      DeviceImage<float>(device, width, height),
                      DeviceImage<float>(device, width, height)};
  ParallelFor(device,
              width,
              height,
              MatchingCostKernel{reference,
                                 sources.Data(),
                                 sources.Size(),
                                 costs.min_cost.View(),
                                 costs.second_cost.View(),
                                 costs.left_right_difference.View()});
  return costs;
}

}  // namespace tsar
