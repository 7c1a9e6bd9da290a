// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/stages/cases.h"

#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"
#include "colmap_tsar/view/regions/edges.h"
#include "colmap_tsar/view/superpixels/superpixel_planes.h"

#include <cmath>
#include <memory>
#include <utility>

#include "benchmarks/stages/label_components.h"

namespace tsar {
namespace {

constexpr double kTaps = 121.0;

// Depth, normal and color are read, depth and normal written.
constexpr double kMedianBytes = 16.0 + 3.0 + 16.0;

StageCase MedianCase(const StageInputs& in, int round) {
  const double radius = in.options.window_radius *
                        std::exp2(in.options.num_iterations - round + 1);
  // Items: taps. The map is full, as none is in R1, so that each counts.
  return {"WeightedMedian/round" + std::to_string(round),
          kTaps * in.NumPixels(),
          kMedianBytes * in.NumPixels(),
          [&in, radius] {
            WeightedMedianFilter(in.views.Hypotheses(),
                                 in.views.Color(),
                                 {},
                                 in.views.MapIntrinsics(),
                                 in.MedianOptions(radius),
                                 in.device);
          }};
}

}  // namespace

std::vector<StageCase> TransferCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  return {
      // Depth 4, normal 12, color 3, gray 4; of each source gray and depth.
      {"Upload",
       pixels,
       (23.0 + 8.0 * in.NumSources()) * pixels,
       [&in] {
         const DeviceViews views(
             in.view_set.reference,
             UploadViews(in.view_set.SourcePointers(), in.device),
             in.device);
       }},
      // Depth 4, normal 12, provenance 1.
      {"Download",
       pixels,
       17.0 * pixels,
       [&in] {
         in.composed.map.depth.ToHost();
         in.composed.map.normal.ToHost();
         in.composed.provenance.ToHost();
       }},
  };
}

std::vector<StageCase> MatchingCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double sources = in.NumSources();
  return {
      // Items: bilinear samples if every pixel has texture and sees all
      // sources: the window and its center in the reference, in each source,
      // and both again for the way back. Bytes: gray, depth and normal of the
      // reference, gray of the sources, three costs.
      {"MatchingCosts",
       (kPatchSize + 1.0) * (sources + 3.0) * pixels,
       (20.0 + 4.0 * sources + 12.0) * pixels,
       [&in] {
         ComputeMatchingCosts(
             in.views.Reference(), in.views.Sources(), in.device);
       }},
      // Items: P S lookups. Bytes: depth of all views, the count.
      {"Agreement",
       sources * pixels,
       (4.0 + 4.0 * sources + 1.0) * pixels,
       [&in] {
         CountAgreeingSources(
             in.views.Reference(), in.views.Sources(), in.device);
       }},
      // Bytes: three costs, the confidence.
      {"Confidence",
       pixels,
       16.0 * pixels,
       [&in] { ComputeConfidence(in.costs, in.device); }},
      // Bytes: depth, the score.
      {"Discontinuity",
       pixels,
       8.0 * pixels,
       [&in] {
         ComputeDiscontinuity(
             in.views.Hypotheses().depth, in.views.Scale(), in.device);
       }},
      // Bytes: depth, two terms and the agreement, the score and the mask.
      {"Aggregation",
       pixels,
       (13.0 + 5.0) * pixels,
       [&in] {
         const DeviceImage<float> score =
             AggregateScores(in.views.Hypotheses().depth,
                             in.confidence.View(),
                             in.discontinuity.View(),
                             in.agreement.View(),
                             {},
                             in.device);
         SelectReliable(score.View(),
                        static_cast<float>(in.options.min_aggregated_score),
                        in.device);
       }},
  };
}

std::vector<StageCase> RefinementCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double raster = in.NumRasterPixels();
  const double slic_rounds = kNumSlicIterations;
  const double rounds = in.options.num_iterations;
  const auto reliable = std::make_shared<DeviceImage<uint8_t>>();
  return {
      // Items: R per round. Bytes: in each round CIELAB, score and label, read
      // for the assignment and again for the means.
      {"Superpixels",
       slic_rounds * raster,
       slic_rounds * 2.0 * 20.0 * raster,
       [&in] {
         ComputeSuperpixels(in.views.RasterColor(),
                            in.raster_score.View(),
                            in.options.superpixel_size,
                            in.device);
       }},
      // Items: samples times hypotheses. Bytes: samples and labels, once.
      {"SuperpixelPlanes",
       GroupPlaneOptions().num_hypotheses * raster,
       (12.0 + 4.0) * raster,
       [&in] {
         FitSuperpixelPlanes(in.superpixel_groups,
                             in.samples.View(),
                             in.views.RasterIntrinsics(),
                             in.views.Scale(),
                             static_cast<float>(in.options.min_plane_support),
                             {},
                             in.device);
       }},
      MedianCase(in, 1),
      MedianCase(in, 4),
      // R1. Items: taps of all rounds. Bytes per round: own depth and normal,
      // color, score, mask in and out, and the estimated planes, written and
      // read.
      {"RefineByCorrelation",
       rounds * kTaps * pixels,
       rounds * (16.0 + 3.0 + 4.0 + 2.0 + 2.0 * 12.0) * pixels,
       [&in, reliable] {
         RefineByCorrelation(in.views,
                             in.score.View(),
                             std::move(*reliable),
                             in.superpixels,
                             in.options,
                             0,
                             in.device);
       },
       [&in, reliable] {
         *reliable = SelectReliable(in.score.View(), in.MinScore(), in.device);
       }},
  };
}

std::vector<StageCase> SegmentationCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double raster = in.NumRasterPixels();
  return {
      // Bytes: color, the edges.
      {"Roberts",
       raster,
       4.0 * raster,
       [&in] {
         DetectRobertsEdges(in.views.RasterColor(),
                            static_cast<float>(in.options.edge_threshold),
                            in.device);
       }},
      // Bytes: the edges, read and drawn.
      {"Hough",
       raster,
       2.0 * raster,
       [&in] {
         DrawLineSegments(in.edges.View(), in.hough_max_gap, in.device);
       }},
      // Bytes: edges, the labels written and read once each.
      {"FindRegions",
       raster,
       (1.0 + 8.0) * raster,
       [&in] {
         FindRegions(in.borders.View(), in.min_region_size, in.device);
       }},
      // Items: R. Bytes: labels and samples read twice, a plane written.
      {"RegionPlanes",
       raster,
       (2.0 * 16.0 + 16.0) * raster,
       [&in] {
         const RegionPlanes planes = FitRegionPlanes(in.regions,
                                                     in.samples.View(),
                                                     in.views.Scale(),
                                                     in.plane_options,
                                                     in.device);
         AssignRegionPlanes(in.regions,
                            planes,
                            in.samples.View(),
                            in.views.RasterIntrinsics(),
                            in.views.Scale(),
                            in.plane_options,
                            in.device);
       }},
      // Bytes: labels, pixel indices.
      {"GroupPixels",
       raster,
       8.0 * raster,
       [&in] {
         GroupPixels(
             in.superpixels.labels.View(), in.superpixels.count, in.device);
       }},
      // Of the whole map. Bytes: depth, labels written, read and written.
      {"LabelComponents",
       pixels,
       (4.0 + 12.0) * pixels,
       [&in] { LabelContinuousDepth(in.views.Hypotheses().depth, in.device); }},
  };
}

std::vector<StageCase> CompositionCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double rounds = in.options.num_iterations;
  const auto own = std::make_shared<DepthNormalImages>();
  const auto composed = std::make_shared<ComposedMap>();
  return {
      // Bytes: a map of depth and normal and a mask; a map and its provenance.
      {"ComposeMap",
       pixels,
       (16.0 + 1.0 + 17.0) * pixels,
       [&in, own] { in.Compose(std::move(*own)); },
       [&in, own] { *own = in.OwnMap(); }},
      // R2. Items: P per round, of which few are holes. Bytes: each round looks
      // for holes in the depth; what it fills depends on the scene.
      {"FillHoles",
       rounds * pixels,
       rounds * 4.0 * pixels,
       [&in, composed] {
         FillHoles(in.views.Color(),
                   in.views.MapIntrinsics(),
                   in.options,
                   in.options.num_iterations,
                   composed.get(),
                   in.device);
       },
       [&in, composed] { *composed = in.Compose(in.OwnMap()); }},
  };
}

}  // namespace tsar
