// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/correlation.h"

#include "colmap_tsar/view/superpixels/superpixel_planes.h"
#include "colmap_tsar/view/superpixels/trust.h"

#include <cmath>
#include <utility>

namespace tsar {

CorrelationResult RefineByCorrelation(const DeviceViews& views,
                                      ImageView<const float> score,
                                      DeviceImage<uint8_t> reliable,
                                      const Superpixels& superpixels,
                                      const RefineOptions& options,
                                      uint32_t image_id,
                                      Device& device) {
  const DepthNormalViews own = views.Hypotheses();
  const int width = views.Width();
  const int height = views.Height();
  CorrelationResult result;
  result.trusted = std::move(reliable);
  PixelGroups groups;
  if (options.superpixel_planes) {
    groups = GroupPixels(superpixels.labels.View(), superpixels.count, device);
  }
  WeightedMedianOptions filter;
  filter.spatial_sigma = static_cast<float>(options.spatial_sigma);
  filter.color_sigma = static_cast<float>(options.color_sigma);
  GroupPlaneOptions ransac;
  ransac.image_id = image_id;
  ransac.seed = static_cast<uint32_t>(options.seed);
  DeviceImage<InverseDepthPlane> estimate(device, width, height);
  for (int round = 1; round <= options.num_iterations; ++round) {
    DeviceImage<Plane> planes;
    if (options.superpixel_planes) {
      const DeviceImage<RayDepth> samples =
          SampleMeasurements(own.depth,
                             score,
                             result.trusted.View(),
                             views.MapIntrinsics(),
                             views.Raster(),
                             device);
      ransac.iteration = round;
      result.planes =
          FitSuperpixelPlanes(groups,
                              samples.View(),
                              views.RasterIntrinsics(),
                              views.Scale(),
                              static_cast<float>(options.min_plane_support),
                              ransac,
                              device);
      planes = PlanesOfLabels(superpixels.labels.View(), result.planes, device);
    }
    const int exponent = options.num_iterations - round + 1;
    filter.radius = ScaledRadius(static_cast<float>(options.window_radius) *
                                     std::exp2(static_cast<float>(exponent)),
                                 width,
                                 height);
    GateRound(own,
              views.OnMap(planes),
              views.Color(),
              options.weighted_median ? &filter : nullptr,
              {score,
               views.Scale(),
               static_cast<float>(options.disparity_tolerance) / round,
               options.readmit_filtered},
              estimate.View(),
              result.trusted.View(),
              device);
  }
  return result;
}

}  // namespace tsar
