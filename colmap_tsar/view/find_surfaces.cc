// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/find_surfaces.h"

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/regions/assign_region_planes.h"
#include "colmap_tsar/view/regions/edges.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/stage_options.h"
#include "colmap_tsar/view/superpixels/correlation.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// A threshold below every score.
constexpr float kAnyScore = -1.f;

// FindSurfaces() with its arguments.
class SurfaceFinder {
 public:
  SurfaceFinder(const ViewData& reference,
                uint32_t image_id,
                const RefineOptions& options,
                DeviceViews* views,
                Device& device,
                StageTimer* timer)
      : reference_(reference),
        image_id_(image_id),
        options_(options),
        views_(*views),
        device_(device),
        timer_(*timer) {}

  Surfaces Run() {
    ScoreHypotheses();
    DeviceImage<uint8_t> reliable = SelectReliable(
        surfaces_.score.View(),
        options_.filter ? static_cast<float>(options_.min_aggregated_score)
                        : kAnyScore,
        device_);
    timer_.Finish("filtering");  // Waits for the device: the sources can go.
    views_.ReleaseSources();
    RefineReliability(std::move(reliable));
    if (options_.segment) {
      surfaces_.region_planes = FindRegionPlanes();
    }
    return std::move(surfaces_);
  }

 private:
  DeviceImage<float> ScoreMatches() const {
    MatchingCosts costs =
        ComputeMatchingCosts(views_.Reference(), views_.Sources(), device_);
    if (!reference_.min_cost.Empty()) {
      costs.min_cost = DeviceImage<float>(device_, reference_.min_cost);
    }
    return ComputeConfidence(costs, device_);
  }

  // Joint hypothesis filtering up to its threshold.
  void ScoreHypotheses() {
    DeviceImage<float> confidence;
    if (options_.filter_confidence) {
      confidence = ScoreMatches();
    }
    DeviceImage<uint8_t> agreement;
    if (options_.view_agreement) {
      agreement = CountAgreeingSources(
          views_.Reference(), views_.Sources(), {}, device_);
      if (options_.confirmed_depths) {
        const ImageView<const float> gray = views_.Reference().gray;
        // Depths that COLMAP's consistency check rejected are no candidates,
        // lest they be confirmed by chance.
        const DeviceImage<uint8_t> is_to_refine(device_,
                                                reference_.is_to_refine);
        surfaces_.confirmations = ConfirmDepths(gray,
                                                agreement.View(),
                                                is_to_refine.View(),
                                                EstimateNoise(gray, device_),
                                                device_);
      }
    }
    timer_.Finish("matching");
    const ImageView<const float> depth = views_.Hypotheses().depth;
    DeviceImage<float> discontinuity;
    if (options_.filter_discontinuity) {
      discontinuity = ComputeDiscontinuity(depth, views_.Scale(), {}, device_);
    }
    ReliabilityOptions reliability;
    reliability.confidence_weight =
        static_cast<float>(options_.confidence_weight);
    reliability.saturating_agreement = std::clamp(
        views_.NumSourcesWithDepth(), 1, reliability.saturating_agreement);
    surfaces_.score = AggregateScores(depth,
                                      confidence.View(),
                                      discontinuity.View(),
                                      agreement.View(),
                                      reliability,
                                      device_);
  }

  // Computes the superpixels, their planes and the trusted pixels.
  void RefineReliability(DeviceImage<uint8_t> reliable) {
    if (!options_.refine) {
      surfaces_.trusted = std::move(reliable);
      return;
    }
    const ImageView<const float> score = surfaces_.score.View();
    SlicOptions slic;
    slic.superpixel_size = options_.superpixel_size;
    surfaces_.superpixels = ComputeSuperpixels(
        views_.RasterColor(),
        ReduceNearest(score, views_.Raster(), device_).View(),
        slic,
        device_);
    timer_.Finish("superpixels");
    CorrelationResult correlation =
        RefineByCorrelation(views_.Hypotheses(),
                            score,
                            std::move(reliable),
                            views_.Color(),
                            surfaces_.superpixels,
                            views_.Raster(),
                            views_.ReferenceCamera(),
                            views_.Scale(),
                            MakeCorrelationOptions(options_, image_id_),
                            device_);
    surfaces_.superpixel_planes = std::move(correlation.planes);
    surfaces_.trusted = std::move(correlation.trusted);
    timer_.Finish("refinement");
  }

  Regions SegmentTexturelessRegions() const {
    const float threshold = static_cast<float>(options_.edge_threshold);
    const DeviceImage<uint8_t> edges =
        DetectRobertsEdges(views_.RasterColor(), threshold, device_);
    const DeviceImage<uint8_t> borders =
        DrawLineSegments(edges.View(),
                         MakeHoughOptions(options_, views_.RasterScale()),
                         device_);
    return FindRegions(
        borders.View(), MinRegionSize(options_, views_.RasterScale()), device_);
  }

  DeviceImage<Plane> FindRegionPlanes() {
    const Regions regions = SegmentTexturelessRegions();
    timer_.Finish("segmentation");
    const RegionPlaneOptions plane_options =
        MakeRegionPlaneOptions(options_, views_.RasterScale(), image_id_);
    const DeviceImage<RayDepth> samples =
        SampleMeasurements(views_.Hypotheses().depth,
                           surfaces_.score.View(),
                           surfaces_.trusted.View(),
                           views_.MapIntrinsics(),
                           views_.Raster(),
                           device_);
    const RegionPlanes fits = FitRegionPlanes(
        regions, samples.View(), views_.Scale(), plane_options, device_);
    DeviceImage<Plane> planes = AssignRegionPlanes(regions,
                                                   fits,
                                                   samples.View(),
                                                   views_.RasterIntrinsics(),
                                                   views_.Scale(),
                                                   plane_options,
                                                   device_);
    timer_.Finish("region planes");
    return planes;
  }

  const ViewData& reference_;
  const uint32_t image_id_;
  const RefineOptions& options_;
  DeviceViews& views_;
  Device& device_;
  StageTimer& timer_;
  Surfaces surfaces_;
};

}  // namespace

Surfaces FindSurfaces(const ViewData& reference,
                      uint32_t image_id,
                      const RefineOptions& options,
                      DeviceViews* views,
                      Device& device,
                      StageTimer* timer) {
  return SurfaceFinder(reference, image_id, options, views, device, timer)
      .Run();
}

ComposedMap ComposeSurfaces(const PlaneRaster& region_planes,
                            const RefineOptions& options,
                            const Surfaces& surfaces,
                            DeviceViews* views,
                            Device& device) {
  DeviceImage<Plane> superpixel_planes;
  if (options.superpixel_planes && surfaces.superpixels.count > 0) {
    superpixel_planes = PlanesOfLabels(
        surfaces.superpixels.labels.View(), surfaces.superpixel_planes, device);
  }
  return ComposeMap(views->TakeHypotheses(),
                    {surfaces.trusted.View(),
                     views->OnMap(superpixel_planes),
                     region_planes,
                     surfaces.confirmations.View()},
                    views->Scale(),
                    {},
                    device);
}

}  // namespace tsar
