// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/view/filter/confidence.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"

#include "benchmarks/stages/cases.h"

namespace tsar {

std::vector<StageCase> TransferCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  return {
      // Depth 4, normal 12, color 3, gray 4; of each source gray and depth.
      {"Upload",
       pixels,
       (23.0 + 8.0 * in.NumSources()) * pixels,
       [&in] {
         const DeviceViews views(
             in.view_set.reference, in.view_set.SourcePointers(), in.device);
       }},
      // Depth 4, normal 12, confidence 4, provenance 1.
      {"Download",
       pixels,
       21.0 * pixels,
       [&in] {
         in.composed.map.depth.ToHost();
         in.composed.map.normal.ToHost();
         in.composed.provenance.ToHost();
         in.confidence.ToHost();
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
             in.views.Reference(), in.views.Sources(), {}, in.device);
       }},
      // Bytes: three costs, the confidence.
      {"Confidence",
       pixels,
       16.0 * pixels,
       [&in] { ComputeConfidence(in.costs, {}, in.device); }},
      // Bytes: depth, the score.
      {"Discontinuity",
       pixels,
       8.0 * pixels,
       [&in] {
         ComputeDiscontinuity(
             in.views.Hypotheses().depth, in.views.Scale(), {}, in.device);
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

}  // namespace tsar
