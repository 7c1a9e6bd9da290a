// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_image.h"

#include "colmap_tsar/pipeline/compose.h"
#include "colmap_tsar/pipeline/device_views.h"
#include "colmap_tsar/pipeline/fill_holes.h"
#include "colmap_tsar/pipeline/find_surfaces.h"
#include "colmap_tsar/pipeline/stage_timer.h"

#include <utility>

namespace tsar {

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
  DeviceViews views(reference, std::move(sources), device);
  timer.Finish("upload");
  const Surfaces surfaces = FindSurfaces(
      reference, image_id, options, &views, device, &timer, observer);
  DeviceImage<Plane> superpixel_planes;
  if (options.superpixel_planes && surfaces.superpixels.count > 0) {
    superpixel_planes = PlanesOfLabels(
        surfaces.superpixels.labels.View(), surfaces.superpixel_planes, device);
  }
  ComposedMap composed = ComposeMap(views.TakeHypotheses(),
                                    {surfaces.trusted.View(),
                                     views.OnMap(superpixel_planes),
                                     views.OnMap(surfaces.region_planes)},
                                    views.Scale(),
                                    {},
                                    device);
  ShowStage(observer, RefineStage::kDepthComposed, composed.map.depth, device);
  FillHoles(views.Color(), views.MapIntrinsics(), options, &composed, device);
  const DeviceImage<float> confidence =
      RateConfidence(composed, surfaces.score.View(), device);
  timer.Finish("composition");
  result.maps = Download(composed, confidence);
  timer.Finish("download");
  ShowMaps(observer, result.maps);
  if (!HasDepth(result.maps.depth)) {
    result.reason_to_keep = kNothingReliable;
  }
  return result;
}

}  // namespace tsar
