// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/single_view.h"

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/correlation.h"
#include "colmap_tsar/view/denoise/estimate_noise.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/regions/edges.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/stage_options.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// A threshold below every score.
constexpr float kAnyScore = -1.f;

// RunSingleViewStages() with its arguments.
struct SingleViewStages {
  const ViewData& reference;
  const uint32_t image_id;
  const RefineOptions& options;
  DeviceViews& views;
  Device& device;
  StageTimer& timer;
  SingleViewResult result{};

  SingleViewResult Run() {
    ScoreHypotheses();
    DeviceImage<uint8_t> reliable = SelectReliable(
        result.score.View(),
        options.filter ? static_cast<float>(options.min_aggregated_score)
                       : kAnyScore,
        device);
    timer.Finish("filtering");  // Waits for the device: the sources can go.
    views.ReleaseSources();
    RefineReliability(std::move(reliable));
    if (options.segment) {
      result.region_planes = FindRegionPlanes();
    }
    return std::move(result);
  }

  DeviceImage<float> ScoreMatches() const {
    MatchingCosts costs =
        ComputeMatchingCosts(views.Reference(), views.Sources(), device);
    if (!reference.min_cost.Empty()) {
      costs.min_cost = DeviceImage<float>(device, reference.min_cost);
    }
    return ComputeConfidence(costs, device);
  }

  // Joint hypothesis filtering up to its threshold.
  void ScoreHypotheses() {
    DeviceImage<float> confidence;
    if (options.filter_confidence) {
      confidence = ScoreMatches();
    }
    DeviceImage<uint8_t> agreement;
    if (options.view_agreement) {
      agreement =
          CountAgreeingSources(views.Reference(), views.Sources(), device);
      if (options.confirmed_depths) {
        const DeviceImage<float> gray = ComputeGray(views.Color(), device);
        result.confirmations = ConfirmDepths(gray.View(),
                                             agreement.View(),
                                             EstimateNoise(gray.View(), device),
                                             device);
      }
    }
    timer.Finish("matching");
    const ImageView<const float> depth = views.Hypotheses().depth;
    DeviceImage<float> discontinuity;
    if (options.filter_discontinuity) {
      discontinuity = ComputeDiscontinuity(depth, views.Scale(), device);
    }
    ReliabilityOptions reliability;
    reliability.confidence_weight =
        static_cast<float>(options.confidence_weight);
    reliability.saturating_agreement = std::clamp(
        views.NumSourcesWithDepth(), 1, reliability.saturating_agreement);
    result.score = AggregateScores(depth,
                                   confidence.View(),
                                   discontinuity.View(),
                                   agreement.View(),
                                   reliability,
                                   device);
  }

  // Computes the superpixels, their planes and the trusted pixels.
  void RefineReliability(DeviceImage<uint8_t> reliable) {
    if (!options.refine) {
      result.trusted = std::move(reliable);
      return;
    }
    const ImageView<const float> score = result.score.View();
    result.superpixels =
        ComputeSuperpixels(views.RasterColor(),
                           ReduceNearest(score, views.Raster(), device).View(),
                           options.superpixel_size,
                           device);
    timer.Finish("superpixels");
    CorrelationResult correlation = RefineByCorrelation(views,
                                                        score,
                                                        std::move(reliable),
                                                        result.superpixels,
                                                        options,
                                                        image_id,
                                                        device);
    result.superpixel_planes = std::move(correlation.planes);
    result.trusted = std::move(correlation.trusted);
    timer.Finish("refinement");
  }

  Regions SegmentTexturelessRegions() const {
    const float threshold = static_cast<float>(options.edge_threshold);
    const DeviceImage<uint8_t> edges =
        DetectRobertsEdges(views.RasterColor(), threshold, device);
    const DeviceImage<uint8_t> borders = DrawLineSegments(
        edges.View(),
        ScaledLength(options.hough_max_gap, views.RasterScale()),
        device);
    return FindRegions(
        borders.View(), MinRegionSize(options, views.RasterScale()), device);
  }

  DeviceImage<Plane> FindRegionPlanes() {
    const Regions regions = SegmentTexturelessRegions();
    timer.Finish("segmentation");
    const RegionPlaneOptions plane_options =
        MakeRegionPlaneOptions(options, views.RasterScale(), image_id);
    const DeviceImage<RayDepth> samples =
        SampleMeasurements(views.Hypotheses().depth,
                           result.score.View(),
                           result.trusted.View(),
                           views.MapIntrinsics(),
                           views.Raster(),
                           device);
    const RegionPlanes fits = FitRegionPlanes(
        regions, samples.View(), views.Scale(), plane_options, device);
    DeviceImage<Plane> planes = AssignRegionPlanes(regions,
                                                   fits,
                                                   samples.View(),
                                                   views.RasterIntrinsics(),
                                                   views.Scale(),
                                                   plane_options,
                                                   device);
    timer.Finish("region planes");
    return planes;
  }
};

}  // namespace

SingleViewResult RunSingleViewStages(const ViewData& reference,
                                     uint32_t image_id,
                                     const RefineOptions& options,
                                     DeviceViews* views,
                                     Device& device,
                                     StageTimer* timer) {
  return SingleViewStages{reference, image_id, options, *views, device, *timer}
      .Run();
}

}  // namespace tsar
