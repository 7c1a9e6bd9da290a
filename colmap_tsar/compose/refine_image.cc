// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/refine_image.h"

#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/fill_holes.h"
#include "colmap_tsar/view/find_surfaces.h"
#include "colmap_tsar/view/stage_timer.h"

#include <utility>

namespace tsar {

std::string ReasonToKeep(const RefinedMaps& maps,
                         const RefineOptions& options) {
  return options.min_confidence <= 0.0 && !HasDepth(maps.depth)
             ? kNothingReliable
             : "";
}

RefineResult RefineImage(const ViewData& reference,
                         const std::vector<const ViewData*>& sources,
                         uint32_t image_id,
                         const RefineOptions& options,
                         Device& device) {
  return RefineImage(
      reference, UploadViews(sources, device), image_id, options, device);
}

RefineResult RefineImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device,
    StageObserver* observer) {
  RefineResult result;
  StageTimer timer(device, &result.seconds);
  DeviceViews views(reference, std::move(sources), device, options.denoise);
  timer.Finish("upload");
  Surfaces surfaces = FindSurfaces(
      reference, image_id, options, &views, device, &timer, observer);
  const PlaneRaster region_planes = views.OnMap(surfaces.region_planes);
  ComposedMap composed;
  if (options.fill_before_regions) {
    composed = std::move(surfaces.filled);
    ApplyRegionPlanes(region_planes, views.Scale(), {}, &composed, device);
  } else {
    composed =
        ComposeSurfaces(region_planes, options, &surfaces, &views, device);
  }
  ShowStage(observer, RefineStage::kDepthComposed, composed.map.depth, device);
  if (!options.fill_before_regions) {
    FillHoles(views.Color(),
              views.MapIntrinsics(),
              options,
              options.num_iterations,
              &composed,
              device);
  }
  DeviceImage<float> confidence = ComputeComposedConfidence(
      composed, std::as_const(surfaces.score).View(), device);
  DropDoubtful(static_cast<float>(options.min_confidence),
               &composed,
               &confidence,
               device);
  if (options.sigma_maps) {
    result.maps.sigma =
        ComputeSigma(composed, views.Scale(), {}, device).ToHost();
  }
  timer.Finish("composition");
  Download(composed, confidence, views.MapIntrinsics(), &result.maps);
  timer.Finish("download");
  ShowMaps(observer, result.maps);
  result.reason_to_keep = ReasonToKeep(result.maps, options);
  return result;
}

}  // namespace tsar
