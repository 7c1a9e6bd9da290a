// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_image.h"

#include "colmap_tsar/filtering/confidence.h"
#include "colmap_tsar/filtering/discontinuity.h"
#include "colmap_tsar/filtering/reliability.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/pipeline/compose.h"
#include "colmap_tsar/pipeline/device_views.h"
#include "colmap_tsar/pipeline/stage_options.h"
#include "colmap_tsar/pipeline/stage_timer.h"
#include "colmap_tsar/refinement/correlation.h"
#include "colmap_tsar/refinement/slic.h"
#include "colmap_tsar/segmentation/hough.h"
#include "colmap_tsar/segmentation/region_planes.h"
#include "colmap_tsar/segmentation/roberts.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

// A threshold below every score.
constexpr float kAnyScore = -1.f;

// num_sources_with_depth: no more than these can agree with a pixel.
DeviceImage<float> ScoreHypotheses(const ViewData& reference,
                                   const DeviceViews& views,
                                   int num_sources_with_depth,
                                   const RefineOptions& options,
                                   Device& device,
                                   StageTimer* timer) {
  DeviceImage<float> confidence;
  if (options.filter_confidence) {
    MatchingCosts costs =
        ComputeMatchingCosts(views.Reference(), views.Sources(), device);
    if (!reference.min_cost.Empty()) {
      costs.min_cost = DeviceImage<float>(device, reference.min_cost);
      costs.second_cost = DeviceImage<float>(device, reference.second_cost);
    }
    confidence = ComputeConfidence(costs, {}, device);
  }
  DeviceImage<uint8_t> agreement;
  if (options.view_agreement) {
    agreement =
        CountAgreeingSources(views.Reference(), views.Sources(), {}, device);
  }
  timer->Finish("matching");
  const ImageView<const float> depth = views.Hypotheses().depth;
  DeviceImage<float> discontinuity;
  if (options.filter_discontinuity) {
    discontinuity = ComputeDiscontinuity(depth, views.Scale(), {}, device);
  }
  ReliabilityOptions reliability;
  reliability.confidence_weight = static_cast<float>(options.confidence_weight);
  reliability.saturating_agreement =
      std::clamp(num_sources_with_depth, 1, reliability.saturating_agreement);
  return AggregateScores(depth,
                         confidence.View(),
                         discontinuity.View(),
                         agreement.View(),
                         reliability,
                         device);
}

// What the refinement leaves for the composition.
struct Refinement {
  DeviceImage<uint8_t> trusted;
  DeviceImage<Plane> superpixel_planes;  // Of the raster's pixels.
};

Refinement RefineTrust(const DeviceViews& views,
                       ImageView<const float> score,
                       DeviceImage<uint8_t> reliable,
                       uint32_t image_id,
                       const RefineOptions& options,
                       Device& device,
                       StageTimer* timer) {
  Refinement result;
  if (!options.refine) {
    result.trusted = std::move(reliable);
    return result;
  }
  SlicOptions slic;
  slic.superpixel_size = options.superpixel_size;
  const Superpixels superpixels =
      ComputeSuperpixels(views.RasterColor(),
                         ReduceNearest(score, views.Raster(), device).View(),
                         slic,
                         device);
  timer->Finish("superpixels");
  CorrelationResult correlation =
      RefineByCorrelation(views.Hypotheses(),
                          score,
                          std::move(reliable),
                          views.Color(),
                          superpixels,
                          views.Raster(),
                          views.ReferenceCamera(),
                          views.Scale(),
                          MakeCorrelationOptions(options, image_id),
                          device);
  if (options.superpixel_planes) {
    result.superpixel_planes =
        PlanesOfLabels(superpixels.labels.View(), correlation.planes, device);
  }
  result.trusted = std::move(correlation.trusted);
  timer->Finish("refinement");
  return result;
}

Regions SegmentTexturelessRegions(const DeviceViews& views,
                                  const RefineOptions& options,
                                  Device& device) {
  const DeviceImage<uint8_t> edges = DetectRobertsEdges(
      views.RasterColor(), static_cast<float>(options.edge_threshold), device);
  const DeviceImage<uint8_t> borders = DrawLineSegments(
      edges.View(), MakeHoughOptions(options, views.RasterScale()), device);
  return FindRegions(
      borders.View(), MinRegionSize(options, views.RasterScale()), device);
}

DeviceImage<Plane> FindRegionPlanes(const DeviceViews& views,
                                    ImageView<const float> score,
                                    ImageView<const uint8_t> trusted,
                                    uint32_t image_id,
                                    const RefineOptions& options,
                                    Device& device,
                                    StageTimer* timer) {
  const Regions regions = SegmentTexturelessRegions(views, options, device);
  timer->Finish("segmentation");
  const RegionPlaneOptions planes =
      MakeRegionPlaneOptions(options, views.RasterScale(), image_id);
  const DeviceImage<RayDepth> samples =
      SampleMeasurements(views.Hypotheses().depth,
                         score,
                         trusted,
                         views.MapIntrinsics(),
                         views.Raster(),
                         device);
  const RegionPlanes fits =
      FitRegionPlanes(regions, samples.View(), views.Scale(), planes, device);
  DeviceImage<Plane> pixel_planes = AssignRegionPlanes(regions,
                                                       fits,
                                                       samples.View(),
                                                       views.RasterIntrinsics(),
                                                       views.Scale(),
                                                       planes,
                                                       device);
  timer->Finish("region planes");
  return pixel_planes;
}

PlaneRaster OnMap(const DeviceImage<Plane>& planes, const DeviceViews& views) {
  return {planes.View(), views.MapIntrinsics(), views.Width(), views.Height()};
}

}  // namespace

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
    Device& device) {
  RefineResult result;
  StageTimer timer(device, &result.seconds);
  const auto num_sources_with_depth =
      std::count_if(sources.begin(), sources.end(), [](const auto& source) {
        return source->has_depth;
      });
  DeviceViews views(reference, std::move(sources), device);
  timer.Finish("upload");
  const DeviceImage<float> score =
      ScoreHypotheses(reference,
                      views,
                      static_cast<int>(num_sources_with_depth),
                      options,
                      device,
                      &timer);
  DeviceImage<uint8_t> reliable = SelectReliable(
      score.View(),
      options.filter ? static_cast<float>(options.min_aggregated_score)
                     : kAnyScore,
      device);
  timer.Finish("filtering");  // Waits for the device: the sources can go.
  views.ReleaseSources();
  const Refinement refinement = RefineTrust(views,
                                            score.View(),
                                            std::move(reliable),
                                            image_id,
                                            options,
                                            device,
                                            &timer);
  DeviceImage<Plane> region_planes;
  if (options.segment) {
    region_planes = FindRegionPlanes(views,
                                     score.View(),
                                     refinement.trusted.View(),
                                     image_id,
                                     options,
                                     device,
                                     &timer);
  }
  ComposedMap composed = ComposeMap(views.TakeHypotheses(),
                                    {refinement.trusted.View(),
                                     OnMap(refinement.superpixel_planes, views),
                                     OnMap(region_planes, views)},
                                    views.Scale(),
                                    {},
                                    device);
  if (options.refine && options.weighted_median) {
    WeightedMedianOptions filter;
    filter.radius = ScaledRadius(
        2.f * options.window_radius, views.Width(), views.Height());
    filter.spatial_sigma = static_cast<float>(options.spatial_sigma);
    filter.color_sigma = static_cast<float>(options.color_sigma);
    filter.min_support = 1.f / 3.f;
    const DeviceImage<uint8_t> filled = InterpolateHoles(views.Color(),
                                                         views.MapIntrinsics(),
                                                         options.num_iterations,
                                                         filter,
                                                         &composed.map,
                                                         device);
    MarkInterpolated(filled.View(), &composed, device);
  }
  const DeviceImage<float> confidence =
      RateConfidence(composed, score.View(), device);
  timer.Finish("composition");
  result.maps.depth = composed.map.depth.ToHost();
  result.maps.normal = composed.map.normal.ToHost();
  result.maps.provenance = composed.provenance.ToHost();
  result.maps.confidence = confidence.ToHost();
  timer.Finish("download");
  if (!HasDepth(result.maps.depth)) {
    result.reason_to_keep = "none of its depths is reliable";
  }
  return result;
}

}  // namespace tsar
