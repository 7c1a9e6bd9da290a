// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/smooth_normals.h"

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

struct SmoothKernel {
  Intrinsics intrinsics;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  SmoothNormalsOptions options;
  ImageView<Vec3f> smoothed;

  TSAR_HD void operator()(int x, int y) const {
    const Vec3f own = normal(x, y);
    smoothed(x, y) = own;
    if (!(depth(x, y) > 0.f)) {
      return;
    }
    const Vec3f ray = intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth(x, y), own);
    Vec3f sum = {};
    for (int v = y - options.radius; v <= y + options.radius; ++v) {
      for (int u = x - options.radius; u <= x + options.radius; ++u) {
        if (u < 0 || v < 0 || u >= depth.width || v >= depth.height ||
            !(depth(u, v) > 0.f) ||
            Dot(own, normal(u, v)) < options.min_cos_angle ||
            fabsf(plane.Depth(intrinsics.Ray(u, v)) - depth(u, v)) >
                options.max_depth_error * depth(u, v)) {
          continue;
        }
        sum = sum + normal(u, v);
      }
    }
    const Vec3f mean = Normalized(sum);
    if (Dot(mean, ray) < 0.f) {
      smoothed(x, y) = mean;
    }
  }
};

}  // namespace

DeviceImage<Vec3f> SmoothNormals(const Intrinsics& intrinsics,
                                 ImageView<const float> depth,
                                 ImageView<const Vec3f> normal,
                                 const SmoothNormalsOptions& options,
                                 Device& device) {
  DeviceImage<Vec3f> smoothed(device, depth.width, depth.height);
  ParallelFor(
      device,
      depth.width,
      depth.height,
      SmoothKernel{intrinsics, depth, normal, options, smoothed.View()});
  return smoothed;
}

}  // namespace tsar
