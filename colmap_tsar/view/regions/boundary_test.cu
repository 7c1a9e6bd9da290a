// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/boundary_test.h"

#include "colmap_tsar/device/parallel_for_teams.h"
#include "colmap_tsar/view/regions/weighted_sum.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

struct RejectKernel {
  ImageView<const int> labels;
  ImageView<const RayDepth> samples;
  PixelGroupsView groups;
  Intrinsics intrinsics;
  float max_gap;
  SupportedPlane* planes;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const int64_t region = item / kMaxPlanesPerRegion;
    const Plane plane = planes[item].plane;
    if (!plane.Valid()) {
      return;
    }
    const WeightedSum gap = team.template Accumulate<WeightedSum>(
        groups.Count(region), [&](int i, WeightedSum* sum) {
          const int pixel = groups.Pixel(region, i);
          AddGap(plane, pixel % labels.width, pixel / labels.width, sum);
        });
    if (team.IsLeader() && gap.weight > 0.0 && !(gap.Mean() < max_gap)) {
      planes[item] = {};
    }
  }

  TSAR_HD void AddGap(const Plane& plane,
                      int x,
                      int y,
                      WeightedSum* gap) const {
    bool is_on_border = false;
    float sum = 0.f;
    int count = 0;
    for (int row = y - 1; row <= y + 1; ++row) {
      for (int column = x - 1; column <= x + 1; ++column) {
        if ((row == y && column == x) || !labels.Contains(column, row)) {
          continue;
        }
        is_on_border |= labels(column, row) != labels(x, y);
        const float z = samples(column, row).z;
        sum += z;
        count += z > 0.f ? 1 : 0;
      }
    }
    if (is_on_border && count > 0) {
      const float depth = plane.Depth(intrinsics.Ray(x, y));
      *gap += {fabsf(depth - sum / count), 1.0};
    }
  }
};

}  // namespace

void RejectByBoundary(const Regions& regions,
                      ImageView<const RayDepth> samples,
                      const Intrinsics& intrinsics,
                      float max_gap,
                      Device& device,
                      RegionPlanes* planes) {
  if (regions.count == 0) {
    return;
  }
  const PixelGroups groups =
      GroupPixels(regions.labels.View(), regions.count, device);
  ParallelForTeams<256>(device,
                        static_cast<int64_t>(planes->planes.Size()),
                        RejectKernel{regions.labels.View(),
                                     samples,
                                     groups.View(),
                                     intrinsics,
                                     max_gap,
                                     planes->planes.Data()});
}

}  // namespace tsar
