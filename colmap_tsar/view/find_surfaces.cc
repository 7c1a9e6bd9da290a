// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/find_surfaces.h"

#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/view/fill_holes.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/regions/assign_region_planes.h"
#include "colmap_tsar/view/regions/boundary_test.h"
#include "colmap_tsar/view/regions/hough.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/regions/roberts.h"
#include "colmap_tsar/view/regions/segment_planes.h"
#include "colmap_tsar/view/score_hypotheses.h"
#include "colmap_tsar/view/stage_options.h"
#include "colmap_tsar/view/superpixels/correlation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

// A threshold below every score.
constexpr float kAnyScore = -1.f;

// Computes the superpixels, their planes and the trusted pixels.
void RefineReliability(const DeviceViews& views,
                       DeviceImage<uint8_t> reliable,
                       uint32_t image_id,
                       const RefineOptions& options,
                       Device& device,
                       StageTimer* timer,
                       StageObserver* observer,
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
  ShowStage(observer,
            RefineStage::kSuperpixels,
            surfaces->superpixels.labels,
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
  surfaces->spread = std::move(correlation.spread);
  ShowMaskedDepth(observer,
                  RefineStage::kDepthTrusted,
                  views.Hypotheses().depth,
                  std::as_const(surfaces->trusted).View(),
                  device);
  if (observer != nullptr && surfaces->superpixel_planes.Size() > 0) {
    ShowStage(observer,
              RefineStage::kSuperpixelPlanes,
              PlanesOfLabels(std::as_const(surfaces->superpixels.labels).View(),
                             surfaces->superpixel_planes,
                             device),
              device);
  }
  timer->Finish("refinement");
}

struct FoundRegions {
  Regions between_edges;
  // The segments of the label image; no labels without a label image.
  Regions segments;
};

// segments: those of the reference image's ViewData.
FoundRegions SegmentTexturelessRegions(const DeviceViews& views,
                                       const Image<uint16_t>& segments,
                                       const RefineOptions& options,
                                       Device& device,
                                       StageObserver* observer) {
  const float threshold = static_cast<float>(options.edge_threshold);
  const DeviceImage<uint8_t> edges =
      options.edges_of_roots
          ? DetectEdgesOfRoots(views.RasterColor(), threshold, device)
          : DetectRobertsEdges(views.RasterColor(), threshold, device);
  const DeviceImage<uint8_t> borders = DrawLineSegments(
      edges.View(), MakeHoughOptions(options, views.RasterScale()), device);
  const int min_size = MinRegionSize(options, views.RasterScale());
  FoundRegions found;
  found.between_edges = FindRegions(borders.View(), min_size, device);
  if (!segments.Empty()) {
    const DeviceImage<uint16_t> on_raster(
        device,
        ResizeNearest<uint16_t>(
            segments, views.Raster().width, views.Raster().height));
    found.segments =
        FindSegments(on_raster.View(), borders.View(), min_size, device);
  }
  ShowStage(observer, RefineStage::kEdges, edges, device);
  ShowStage(observer, RefineStage::kLines, borders, device);
  ShowStage(
      observer, RefineStage::kRegions, found.between_edges.labels, device);
  return found;
}

// The depths to which the planes of regions are fitted, and the mask of usable
// pixels.
struct RegionEvidence {
  ImageView<const float> depth;
  ImageView<const uint8_t> reliable;
};

RegionEvidence EvidenceOfRegions(const DeviceViews& views,
                                 const Surfaces& surfaces) {
  if (!surfaces.filled.map.depth.Empty()) {
    return {surfaces.filled.map.depth.View(),
            surfaces.filled.provenance.View()};
  }
  return {surfaces.spread.depth.Empty() ? views.Hypotheses().depth
                                        : surfaces.spread.depth.View(),
          surfaces.trusted.View()};
}

// Fits the planes of regions to the samples and assigns them to pixels.
DeviceImage<Plane> FitAndAssignPlanes(const DeviceViews& views,
                                      const Regions& regions,
                                      ImageView<const RayDepth> samples,
                                      const RegionPlaneOptions& planes,
                                      double max_boundary_gap,
                                      Device& device) {
  RegionPlanes fits =
      FitRegionPlanes(regions, samples, views.Scale(), planes, device);
  if (max_boundary_gap > 0.0) {
    RejectByBoundary(regions,
                     samples,
                     views.RasterIntrinsics(),
                     static_cast<float>(max_boundary_gap),
                     device,
                     &fits);
  }
  return AssignRegionPlanes(regions,
                            fits,
                            samples,
                            views.RasterIntrinsics(),
                            views.Scale(),
                            planes,
                            device);
}

DeviceImage<Plane> FindRegionPlanes(const DeviceViews& views,
                                    const Image<uint16_t>& segments,
                                    ImageView<const float> score,
                                    const RegionEvidence& evidence,
                                    uint32_t image_id,
                                    const RefineOptions& options,
                                    Device& device,
                                    StageTimer* timer,
                                    StageObserver* observer) {
  const FoundRegions found =
      SegmentTexturelessRegions(views, segments, options, device, observer);
  timer->Finish("segmentation");
  const RegionPlaneOptions planes =
      MakeRegionPlaneOptions(options, views.RasterScale(), image_id);
  const DeviceImage<RayDepth> samples =
      SampleMeasurements(evidence.depth,
                         score,
                         evidence.reliable,
                         views.MapIntrinsics(),
                         views.Raster(),
                         device);
  const auto planes_of = [&](const Regions& regions) {
    return FitAndAssignPlanes(views,
                              regions,
                              samples.View(),
                              planes,
                              options.max_boundary_gap,
                              device);
  };
  DeviceImage<Plane> pixel_planes = planes_of(found.between_edges);
  if (found.segments.count > 0) {
    const DeviceImage<Plane> segment_planes = planes_of(found.segments);
    TakePlanesOfSegments(found.segments,
                         samples.View(),
                         segment_planes.View(),
                         planes.max_boundary_error,
                         pixel_planes.View(),
                         device);
  }
  ShowStage(observer, RefineStage::kRegionPlanes, pixel_planes, device);
  timer->Finish("region planes");
  return pixel_planes;
}

}  // namespace

Surfaces FindSurfaces(const ViewData& reference,
                      uint32_t image_id,
                      const RefineOptions& options,
                      DeviceViews* views,
                      Device& device,
                      StageTimer* timer,
                      StageObserver* observer) {
  Surfaces surfaces;
  ShowStage(observer, RefineStage::kImage, views->RasterColor(), device);
  ShowStage(
      observer, RefineStage::kDepthInput, views->Hypotheses().depth, device);
  ShowStage(
      observer, RefineStage::kNormalsInput, views->Hypotheses().normal, device);
  HypothesisScores scores =
      ScoreHypotheses(reference, *views, options, device, timer, observer);
  surfaces.score = std::move(scores.score);
  surfaces.confirmations = std::move(scores.confirmations);
  ShowStage(observer, RefineStage::kScore, surfaces.score, device);
  DeviceImage<uint8_t> reliable = SelectReliable(
      surfaces.score.View(),
      options.filter ? static_cast<float>(options.min_aggregated_score)
                     : kAnyScore,
      device);
  ShowMaskedDepth(observer,
                  RefineStage::kDepthReliable,
                  views->Hypotheses().depth,
                  std::as_const(reliable).View(),
                  device);
  timer->Finish("filtering");  // Waits for the device: the sources can go.
  views->ReleaseSources();
  RefineReliability(*views,
                    std::move(reliable),
                    image_id,
                    options,
                    device,
                    timer,
                    observer,
                    &surfaces);
  if (options.fill_before_regions) {
    surfaces.filled = ComposeSurfaces({}, options, &surfaces, views, device);
    FillHoles(views->Color(),
              views->MapIntrinsics(),
              options,
              options.num_iterations,
              &surfaces.filled,
              device);
    timer->Finish("composition");
  }
  if (options.segment) {
    surfaces.region_planes =
        FindRegionPlanes(*views,
                         reference.segments,
                         surfaces.score.View(),
                         EvidenceOfRegions(*views, surfaces),
                         image_id,
                         options,
                         device,
                         timer,
                         observer);
  }
  return surfaces;
}

ComposedMap ComposeSurfaces(const PlaneRaster& region_planes,
                            const RefineOptions& options,
                            Surfaces* surfaces,
                            DeviceViews* views,
                            Device& device) {
  const bool is_spread = !surfaces->spread.depth.Empty();
  DeviceImage<Plane> superpixel_planes;
  if (options.superpixel_planes && surfaces->superpixels.count > 0 &&
      !is_spread) {
    superpixel_planes =
        PlanesOfLabels(std::as_const(surfaces->superpixels.labels).View(),
                       surfaces->superpixel_planes,
                       device);
  }
  return ComposeMap(
      is_spread ? std::move(surfaces->spread) : views->TakeHypotheses(),
      {std::as_const(surfaces->trusted).View(),
       views->OnMap(superpixel_planes),
       region_planes,
       std::as_const(surfaces->confirmations).View()},
      views->Scale(),
      {},
      device);
}

}  // namespace tsar
