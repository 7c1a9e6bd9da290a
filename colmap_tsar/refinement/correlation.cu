// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/refinement/correlation.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// The plane's value where there is one, else the trusted pixel's own.
struct OverlayKernel {
  DepthNormalViews own;
  DepthNormalViews rendered;  // May be empty.
  ImageView<const uint8_t> trusted;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    if (!rendered.depth.Empty() && rendered.depth(x, y) > 0.f) {
      depth(x, y) = rendered.depth(x, y);
      normal(x, y) = rendered.normal(x, y);
    } else if (trusted(x, y) != 0) {
      depth(x, y) = own.depth(x, y);
      normal(x, y) = own.normal(x, y);
    } else {
      depth(x, y) = 0.f;
      normal(x, y) = {};
    }
  }
};

struct TrustKernel {
  ImageView<const float> own_depth;
  ImageView<const float> estimated_depth;
  ImageView<const float> score;
  DisparityScale scale;
  float tolerance;  // mu / N_c
  bool readmit_filtered;
  ImageView<uint8_t> trusted;

  TSAR_HD void operator()(int x, int y) const {
    const float own = own_depth(x, y);
    const float estimated = estimated_depth(x, y);
    const float n_aggr = score(x, y);
    // Multiplied out. A pixel with no score at all would pass any gate, so it
    // must have been trusted before.
    trusted(x, y) =
        own > 0.f && estimated > 0.f && (n_aggr > 0.f || trusted(x, y) != 0) &&
                fabsf(scale.ToDisparity(estimated) - scale.ToDisparity(own)) *
                        n_aggr <
                    tolerance &&
                (readmit_filtered || trusted(x, y) != 0)
            ? 1
            : 0;
  }
};

struct FindHolesKernel {
  ImageView<const float> depth;
  ImageView<uint8_t> holes;
  TSAR_HD void operator()(int x, int y) const {
    holes(x, y) = depth(x, y) > 0.f ? 0 : 1;
  }
};

struct FillHolesKernel {
  DepthNormalViews filled;
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> interpolated;

  TSAR_HD void operator()(int x, int y) const {
    if (!(depth(x, y) > 0.f) && filled.depth(x, y) > 0.f) {
      depth(x, y) = filled.depth(x, y);
      normal(x, y) = filled.normal(x, y);
      interpolated(x, y) = 1;
    }
  }
};

struct CopyMaskKernel {
  ImageView<const uint8_t> source;
  ImageView<uint8_t> target;
  TSAR_HD void operator()(int x, int y) const { target(x, y) = source(x, y); }
};

}  // namespace

CorrelationResult RefineByCorrelation(const DepthNormalViews& own,
                                      ImageView<const float> score,
                                      ImageView<const uint8_t> reliable,
                                      ImageView<const Rgb> color,
                                      const Superpixels& superpixels,
                                      const ReducedRaster& raster,
                                      const Camera& camera,
                                      const DisparityScale& scale,
                                      const CorrelationOptions& options,
                                      Device& device) {
  const int width = own.depth.width;
  const int height = own.depth.height;
  const Intrinsics intrinsics = camera.GetIntrinsics();
  const Intrinsics raster_intrinsics =
      camera.Resized(raster.width, raster.height).GetIntrinsics();
  CorrelationResult result;
  result.trusted = DeviceImage<uint8_t>(device, width, height);
  ParallelFor(
      device, width, height, CopyMaskKernel{reliable, result.trusted.View()});
  for (int round = 1; round <= options.num_iterations; ++round) {
    DepthNormalImages rendered;
    if (options.use_superpixel_planes) {
      const DeviceImage<RayDepth> samples = SampleMeasurements(
          own.depth, score, result.trusted.View(), intrinsics, raster, device);
      SuperpixelPlaneOptions plane_options = options.planes;
      plane_options.ransac.iteration = round;
      result.planes = FitSuperpixelPlanes(superpixels,
                                          samples.View(),
                                          raster_intrinsics,
                                          scale,
                                          plane_options,
                                          device);
      const DeviceImage<Plane> planes =
          PlanesOfLabels(superpixels.labels.View(), result.planes, device);
      rendered = RenderPlanes(planes.View(), intrinsics, width, height, device);
    }
    DepthNormalImages overlaid(device, width, height);
    ParallelFor(device,
                width,
                height,
                OverlayKernel{own,
                              rendered.Views(),
                              result.trusted.View(),
                              overlaid.depth.View(),
                              overlaid.normal.View()});
    if (options.use_weighted_median) {
      WeightedMedianOptions filter;
      filter.radius = ScaledRadius(
          options.window_radius *
              std::exp2(static_cast<float>(options.num_iterations - round + 1)),
          width,
          height);
      filter.spatial_sigma = options.spatial_sigma;
      filter.color_sigma = options.color_sigma;
      overlaid = WeightedMedianFilter(
          overlaid.Views(), color, {}, intrinsics, filter, device);
    }
    ParallelFor(device,
                width,
                height,
                TrustKernel{own.depth,
                            overlaid.depth.View(),
                            score,
                            scale,
                            options.disparity_tolerance / round,
                            options.readmit_filtered,
                            result.trusted.View()});
  }
  return result;
}

DeviceImage<uint8_t> InterpolateHoles(ImageView<const Rgb> color,
                                      const Intrinsics& intrinsics,
                                      int num_iterations,
                                      const WeightedMedianOptions& first,
                                      DepthNormalImages* map,
                                      Device& device) {
  const int width = color.width;
  const int height = color.height;
  DeviceImage<uint8_t> interpolated(device, width, height);
  Fill(device,
       interpolated.View().data,
       interpolated.View().NumPixels(),
       uint8_t{0});
  WeightedMedianOptions options = first;
  for (int round = 0; round < num_iterations; ++round) {
    DeviceImage<uint8_t> holes(device, width, height);
    ParallelFor(device,
                width,
                height,
                FindHolesKernel{map->depth.View(), holes.View()});
    const DepthNormalImages filled = WeightedMedianFilter(
        map->Views(), color, holes.View(), intrinsics, options, device);
    ParallelFor(device,
                width,
                height,
                FillHolesKernel{filled.Views(),
                                map->depth.View(),
                                map->normal.View(),
                                interpolated.View()});
    options.radius *= 2.f;
  }
  return interpolated;
}

}  // namespace tsar
