// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/correlation.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/view/superpixels/trust.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

struct FindHolesKernel {
  ImageView<const float> depth;
  TSAR_HD uint8_t operator()(int x, int y) const {
    return depth(x, y) > 0.f ? 0 : 1;
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

// The options of F_A in this round, for a map of this size.
WeightedMedianOptions FilterOfRound(const CorrelationOptions& options,
                                    int round,
                                    int width,
                                    int height) {
  const int exponent = options.num_iterations - round + 1;
  WeightedMedianOptions filter;
  filter.spatial_sigma = options.spatial_sigma;
  filter.color_sigma = options.color_sigma;
  filter.radius = ScaledRadius(
      options.window_radius * std::exp2(static_cast<float>(exponent)),
      width,
      height);
  return filter;
}

}  // namespace

CorrelationResult RefineByCorrelation(const DepthNormalViews& own,
                                      ImageView<const float> score,
                                      DeviceImage<uint8_t> reliable,
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
  result.trusted = std::move(reliable);
  PixelGroups groups;
  if (options.use_superpixel_planes) {
    groups = GroupPixels(superpixels.labels.View(), superpixels.count, device);
  }
  DeviceImage<InverseDepthPlane> estimate(device, width, height);
  for (int round = 1; round <= options.num_iterations; ++round) {
    DeviceImage<Plane> planes;
    if (options.use_superpixel_planes) {
      const DeviceImage<RayDepth> samples = SampleMeasurements(
          own.depth, score, result.trusted.View(), intrinsics, raster, device);
      SuperpixelPlaneOptions plane_options = options.planes;
      plane_options.ransac.iteration = round;
      result.planes = FitSuperpixelPlanes(groups,
                                          samples.View(),
                                          raster_intrinsics,
                                          scale,
                                          plane_options,
                                          device);
      planes = PlanesOfLabels(superpixels.labels.View(), result.planes, device);
    }
    const PlaneRaster on_map{planes.View(), intrinsics, width, height};
    const WeightedMedianOptions filter_of_round =
        FilterOfRound(options, round, width, height);
    const WeightedMedianOptions* const filter =
        options.use_weighted_median ? &filter_of_round : nullptr;
    const TrustGate gate{own.depth,
                         score,
                         scale,
                         options.disparity_tolerance / round,
                         options.readmit_filtered};
    GateRound(own,
              on_map,
              color,
              filter,
              gate,
              estimate.View(),
              result.trusted.View(),
              device);
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
    const DeviceImage<uint8_t> holes = MapPixels<uint8_t>(
        device, width, height, FindHolesKernel{map->depth.View()});
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
