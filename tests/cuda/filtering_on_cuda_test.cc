// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/agreement.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/filter/discontinuity.h"
#include "colmap_tsar/view/filter/reliability.h"

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

TEST_F(CudaTest, ComputeMatchingCosts) {
  ExpectAlike("ComputeMatchingCosts",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const MatchingCosts costs = ComputeMatchingCosts(
                    inputs.views.Reference(), inputs.views.Sources(), device);
                result->Add("min_cost", costs.min_cost);
                result->Add("second_cost", costs.second_cost);
                result->Add("left_right_difference",
                            costs.left_right_difference);
              });
}

TEST_F(CudaTest, CountAgreeingSources) {
  ExpectAlike(
      "CountAgreeingSources",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        result->Add(
            "count",
            CountAgreeingSources(
                inputs.views.Reference(), inputs.views.Sources(), {}, device));
      });
}

TEST_F(CudaTest, ComputeConfidence) {
  ExpectAlike(
      "ComputeConfidence",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const auto random = [&](float max, uint32_t seed) {
          return DeviceImage<float>(
              device,
              RandomImage(
                  inputs.views.Width(), inputs.views.Height(), max, seed));
        };
        const MatchingCosts costs{
            random(1.f, 1), random(2.f, 2), random(1.f, 3)};
        result->Add("confidence", ComputeConfidence(costs, device));
      });
}

TEST_F(CudaTest, ComputeDiscontinuity) {
  ExpectAlike("ComputeDiscontinuity",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add(
                    "discontinuity",
                    ComputeDiscontinuity(inputs.views.Hypotheses().depth,
                                         inputs.views.Scale(),
                                         {},
                                         device));
              });
}

TEST_F(CudaTest, AggregateScoresAndSelectReliable) {
  ExpectAlike("AggregateScores, SelectReliable",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const ReliabilityOptions options;
                const DeviceImage<float> score =
                    AggregateScores(inputs.views.Hypotheses().depth,
                                    inputs.score.View(),
                                    inputs.score.View(),
                                    inputs.reliable.View(),
                                    options,
                                    device);
                result->Add("score", score);
                result->Add("reliable",
                            SelectReliable(inputs.score.View(), 0.7f, device));
              });
}

}  // namespace
}  // namespace tsar
