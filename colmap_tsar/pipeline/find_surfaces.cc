// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/find_surfaces.h"

#include "colmap_tsar/filtering/confidence.h"
#include "colmap_tsar/filtering/discontinuity.h"
#include "colmap_tsar/filtering/reliability.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/pipeline/stage_options.h"
#include "colmap_tsar/refinement/correlation.h"
#include "colmap_tsar/segmentation/hough.h"
#include "colmap_tsar/segmentation/region_planes.h"
#include "colmap_tsar/segmentation/roberts.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// A threshold below every score.
constexpr float kAnyScore = -1.f;

DeviceImage<float> ScoreHypotheses(const ViewData& reference,
                                   const DeviceViews& views,
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
  reliability.saturating_agreement = std::clamp(
      views.NumSourcesWithDepth(), 1, reliability.saturating_agreement);
  return AggregateScores(depth,
                         confidence.View(),
                         discontinuity.View(),
                         agreement.View(),
                         reliability,
                         device);
}

// Sets superpixels, their planes and whom to trust.
void RefineTrust(const DeviceViews& views,
                 DeviceImage<uint8_t> reliable,
                 uint32_t image_id,
                 const RefineOptions& options,
                 Device& device,
                 StageTimer* timer,
                 Surfaces* surfaces) {
  if (!options.refine) {
    surfaces->trusted = std::move(reliable);
    return;
  }
  const ImageView<const float> score = std::as_const(surfaces->score).View();
  SlicOptions slic;
  slic.superpixel_size = options.superpixel_size;
  surfaces->superpixels =
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
                          surfaces->superpixels,
                          views.Raster(),
                          views.ReferenceCamera(),
                          views.Scale(),
                          MakeCorrelationOptions(options, image_id),
                          device);
  surfaces->superpixel_planes = std::move(correlation.planes);
  surfaces->trusted = std::move(correlation.trusted);
  timer->Finish("refinement");
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

}  // namespace

Surfaces FindSurfaces(const ViewData& reference,
                      uint32_t image_id,
                      const RefineOptions& options,
                      DeviceViews* views,
                      Device& device,
                      StageTimer* timer) {
  Surfaces surfaces;
  surfaces.score = ScoreHypotheses(reference, *views, options, device, timer);
  DeviceImage<uint8_t> reliable = SelectReliable(
      surfaces.score.View(),
      options.filter ? static_cast<float>(options.min_aggregated_score)
                     : kAnyScore,
      device);
  timer->Finish("filtering");  // Waits for the device: the sources can go.
  views->ReleaseSources();
  RefineTrust(
      *views, std::move(reliable), image_id, options, device, timer, &surfaces);
  if (options.segment) {
    surfaces.region_planes = FindRegionPlanes(*views,
                                              surfaces.score.View(),
                                              surfaces.trusted.View(),
                                              image_id,
                                              options,
                                              device,
                                              timer);
  }
  return surfaces;
}

}  // namespace tsar
