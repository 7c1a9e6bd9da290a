// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/superpixel_planes.h"

#include "colmap_tsar/device/parallel_for_teams.h"

namespace tsar {
namespace {

// A sum of pixel positions.
struct Position {
  int64_t x = 0;
  int64_t y = 0;
  TSAR_HD Position& operator+=(const Position& other) {
    x += other.x;
    y += other.y;
    return *this;
  }
};

struct AcceptKernel {
  const GroupPlane* fits;
  PixelGroupsView superpixels;
  int width;
  Intrinsics intrinsics;
  float min_support;
  Plane* planes;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t k) const {
    const GroupPlane& fit = fits[k];
    const bool is_supported = fit.plane.Valid() &&
                              fit.num_samples > min_support * fit.num_pixels &&
                              fit.num_inliers >= min_support * fit.num_samples;
    const bool is_acceptable = is_supported && IsInRange(team, fit, k);
    if (team.IsLeader()) {
      planes[k] = is_acceptable ? fit.plane : Plane{};
    }
  }

  // Whether the plane's depth at the center is in the range of the samples.
  template <typename Team>
  TSAR_HD bool IsInRange(const Team& team,
                         const GroupPlane& fit,
                         int64_t k) const {
    const Position sum = team.template Accumulate<Position>(
        fit.num_pixels, [&](int i, Position* position) {
          const int pixel = superpixels.Pixel(k, i);
          *position += {pixel % width, pixel / width};
        });
    const float depth = fit.plane.Depth(
        intrinsics.Ray(static_cast<float>(sum.x) / fit.num_pixels,
                       static_cast<float>(sum.y) / fit.num_pixels));
    return depth >= 0.8f * fit.min_depth && depth <= 1.2f * fit.max_depth;
  }
};

}  // namespace

Buffer<Plane> FitSuperpixelPlanes(const PixelGroups& superpixels,
                                  ImageView<const RayDepth> samples,
                                  const Intrinsics& intrinsics,
                                  const DisparityScale& scale,
                                  float min_support,
                                  const GroupPlaneOptions& ransac,
                                  Device& device) {
  const Buffer<GroupPlane> fits =
      FitGroupPlanes(superpixels, samples, scale, ransac, device);
  Buffer<Plane> planes(device, superpixels.NumGroups());
  ParallelForTeams<32>(device,
                       superpixels.NumGroups(),
                       AcceptKernel{fits.Data(),
                                    superpixels.View(),
                                    samples.width,
                                    intrinsics,
                                    min_support,
                                    planes.Data()});
  return planes;
}

}  // namespace tsar
