// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/refinement/superpixel_planes.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

struct AcceptKernel {
  const GroupPlane* fits;
  const int* begin;
  const int* pixels;
  int width;
  Intrinsics intrinsics;
  float min_support;
  Plane* planes;

  TSAR_HD void operator()(int64_t k) const {
    const GroupPlane& fit = fits[k];
    planes[k] = IsAcceptable(fit, static_cast<int>(k)) ? fit.plane : Plane{};
  }

  TSAR_HD bool IsAcceptable(const GroupPlane& fit, int k) const {
    if (!fit.plane.Valid() ||
        fit.num_samples <= min_support * fit.num_pixels ||
        fit.num_inliers < min_support * fit.num_samples) {
      return false;
    }
    float x = 0.f;
    float y = 0.f;
    for (int i = begin[k]; i < begin[k + 1]; ++i) {
      x += pixels[i] % width;
      y += pixels[i] / width;
    }
    const float depth = fit.plane.Depth(
        intrinsics.Ray(x / fit.num_pixels, y / fit.num_pixels));
    return depth >= 0.8f * fit.min_depth && depth <= 1.2f * fit.max_depth;
  }
};

}  // namespace

Buffer<Plane> FitSuperpixelPlanes(const Superpixels& superpixels,
                                  ImageView<const RayDepth> samples,
                                  const Intrinsics& intrinsics,
                                  const DisparityScale& scale,
                                  const SuperpixelPlaneOptions& options,
                                  Device& device) {
  const PixelGroups groups =
      GroupPixels(superpixels.labels.View(), superpixels.count, device);
  const Buffer<GroupPlane> fits =
      FitGroupPlanes(groups, samples, scale, options.ransac, device);
  Buffer<Plane> planes(device, superpixels.count);
  ParallelFor(device,
              superpixels.count,
              AcceptKernel{fits.Data(),
                           groups.begin.Data(),
                           groups.pixels.Data(),
                           samples.width,
                           intrinsics,
                           options.min_support,
                           planes.Data()});
  return planes;
}

}  // namespace tsar
