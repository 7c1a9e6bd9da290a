// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/boundary_test.h"

#include "colmap_tsar/device/parallel_for_teams.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

struct MeanGap {
  double sum = 0.0;
  int count = 0;
  TSAR_HD MeanGap& operator+=(const MeanGap& other) {
    sum += other.sum;
    count += other.count;
    return *this;
  }
};

struct RejectKernel {
  ImageView<const int> labels;
  ImageView<const RayDepth> samples;
  const int* begin;
  const int* pixels;
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
    const MeanGap gap = team.template Accumulate<MeanGap>(
        begin[region + 1] - begin[region], [&](int i, MeanGap* mean) {
          const int pixel = pixels[begin[region] + i];
          AddGap(plane, pixel % labels.width, pixel / labels.width, mean);
        });
    if (team.IsLeader() && gap.count > 0 && !(gap.sum / gap.count < max_gap)) {
      planes[item] = {};
    }
  }

  TSAR_HD void AddGap(const Plane& plane, int x, int y, MeanGap* mean) const {
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
      *mean += {fabsf(depth - sum / count), 1};
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
                                     groups.begin.Data(),
                                     groups.pixels.Data(),
                                     intrinsics,
                                     max_gap,
                                     planes->planes.Data()});
}

int64_t RejectByBoundaryWorkingBytes(int64_t num_pixels, int64_t num_regions) {
  return std::max(GroupPixelsWorkingBytes(num_pixels, num_regions),
                  PixelGroupsBytes(num_pixels, num_regions));
}

}  // namespace tsar
