// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/filter/reliability.h"

#include <cmath>
#include <memory>
#include <utility>

#include "benchmarks/stages/cases.h"

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

std::vector<StageCase> RefinementCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double raster = in.NumRasterPixels();
  const double slic_rounds = SlicOptions().num_iterations;
  const double rounds = in.options.num_iterations;
  const auto reliable = std::make_shared<DeviceImage<uint8_t>>();
  return {
      // Items: R per round. Bytes: in each round CIELAB, score and label, read
      // for the assignment and again for the means.
      {"Superpixels",
       slic_rounds * raster,
       slic_rounds * 2.0 * 20.0 * raster,
       [&in] {
         ComputeSuperpixels(
             in.views.RasterColor(), in.raster_score.View(), {}, in.device);
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
         RefineByCorrelation(in.views.Hypotheses(),
                             in.score.View(),
                             std::move(*reliable),
                             in.views.Color(),
                             in.superpixels,
                             in.views.Raster(),
                             in.views.ReferenceCamera(),
                             in.views.Scale(),
                             {},
                             in.device);
       },
       [&in, reliable] {
         *reliable = SelectReliable(in.score.View(), in.MinScore(), in.device);
       }},
  };
}

}  // namespace tsar
