// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <vector>

#include "tests/scene/evidence/gather_evidence_fixture.h"
#include "tests/support/synthetic_observations.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kSigma = 0.02f;
constexpr float kOutlierShare = 0.1f;

// With priors that lie on the plane of the view.
class PriorEvidenceTest : public GatherEvidenceTest {
 protected:
  PriorEvidenceTest() { DrawPrior(plane_); }

  void DrawPrior(const Plane& plane) {
    inputs_.prior.depth = DrawDepth(plane, camera_);
    inputs_.prior.sigma = Image<float>(kWidth, kHeight, kSigma);
    inputs_.prior.outlier_share = kOutlierShare;
  }
  // Measures the upper left pixel alone.
  void MeasureOnePixel(int superpixel, const Plane& plane) {
    Fill(&inputs_.samples, superpixel, RayDepth{});
    const int x = superpixel % kNumColumns * kSize;
    const int y = superpixel / kNumColumns * kSize;
    const Vec3f ray = inputs_.intrinsics.Ray(x, y);
    inputs_.samples(x, y) = {ray.x, ray.y, plane.Depth(ray)};
  }
  static std::vector<ObservationSource> SourcesOf(const ViewEvidence& evidence,
                                                  int superpixel) {
    const auto begin = evidence.sources.begin();
    return {begin + evidence.first_observation[superpixel],
            begin + evidence.first_observation[superpixel + 1]};
  }
  static int Count(const std::vector<ObservationSource>& sources,
                   ObservationSource source) {
    return static_cast<int>(std::count(sources.begin(), sources.end(), source));
  }
};

TEST_F(PriorEvidenceTest, WithoutItsPriorEvidenceIsThatOfMeasurements) {
  Fill(&inputs_.samples, 3, RayDepth{});
  MeasureOnePixel(2, plane_);
  inputs_.prior.assessment = {PriorVerdict::kUsed, PriorType::kInverse, 0.8f};
  ViewEvidence evidence = Gather();
  RemovePrior(&evidence);
  inputs_.prior = {};
  const ViewEvidence expected = Gather();
  EXPECT_EQ(evidence.first_observation, expected.first_observation);
  EXPECT_EQ(evidence.sources, expected.sources);
  EXPECT_TRUE(evidence.errors.empty());
  ASSERT_EQ(evidence.observations.size(), expected.observations.size());
  for (size_t i = 0; i < expected.observations.size(); ++i) {
    EXPECT_EQ(evidence.observations[i].sample.z,
              expected.observations[i].sample.z);
  }
  for (size_t k = 0; k < expected.weights.size(); ++k) {
    EXPECT_NEAR(evidence.weights[k], expected.weights[k], 1e-4f);
  }
  EXPECT_TRUE(evidence.prior.Empty());
  EXPECT_EQ(evidence.prior.assessment.verdict, PriorVerdict::kOthersUnlike);
  EXPECT_EQ(evidence.prior.assessment.skill, 0.8f);
}

TEST_F(PriorEvidenceTest, FillsSuperpixelsOfWhichNothingElseIsKnown) {
  Fill(&inputs_.samples, 3, RayDepth{});
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.sources.size(), evidence.observations.size());
  ASSERT_EQ(evidence.errors.size(), evidence.observations.size());
  EXPECT_EQ(SourcesOf(evidence, 3),
            std::vector<ObservationSource>(12, ObservationSource::kPrior));
  // Ten pixels of a prior count as one, less its outliers.
  const float weight = 0.1f * (1.f - kOutlierShare) * kNumPixels;
  EXPECT_NEAR(evidence.weights[3], weight, 1e-3f);
  float sum = 0.f;
  for (const Observation& observation : ObservationsOf(evidence, 3)) {
    EXPECT_NEAR(RelativeDistance(plane_, observation.sample), 0.f, 1e-5f);
    sum += observation.confidence;
  }
  EXPECT_NEAR(sum, weight, 1e-3f);
  EXPECT_EQ(evidence.FirstOfPrior(3), evidence.first_observation[3]);
  // A measured superpixel keeps its measurements alone.
  EXPECT_EQ(SourcesOf(evidence, 2),
            std::vector<ObservationSource>(32, ObservationSource::kMeasured));
  EXPECT_EQ(evidence.FirstOfPrior(2), evidence.first_observation[3]);
  EXPECT_EQ(evidence.confident_depth(35, 5), 0.f);
  EXPECT_TRUE(evidence.prior.depth.HasSizeOf(inputs_.prior.depth));
  EXPECT_EQ(evidence.prior.outlier_share, kOutlierShare);
}

TEST_F(PriorEvidenceTest, ErrorsGrowWithSigma) {
  Fill(&inputs_.samples, 3, RayDepth{});
  const auto expect_errors = [&](float factor) {
    const ViewEvidence evidence = Gather();
    for (size_t i = 0; i < evidence.observations.size(); ++i) {
      if (!evidence.IsOfPrior(i)) {
        EXPECT_EQ(evidence.ErrorOf(i), 1.f);
        continue;
      }
      const float z = evidence.observations[i].sample.z;
      const float expected = factor * kSigma / (0.001f * z);
      EXPECT_NEAR(evidence.ErrorOf(i), expected, 1e-3f * expected);
    }
  };
  expect_errors(2.f);
  Fill(&inputs_.prior.sigma, 3, 3.f * kSigma);
  expect_errors(6.f);
  inputs_.tolerance = 2.f;
  expect_errors(3.f);
  // They are never more precise than measurements.
  Fill(&inputs_.prior.sigma, 3, 1e-6f);
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.errors, std::vector<float>(evidence.errors.size(), 1.f));
}

TEST_F(PriorEvidenceTest, ComesLastAndWeighsWhatItDoesInTheSuperpixel) {
  // A row of superpixel 0 is not measured, all but a row of superpixel 1.
  for (int x = 0; x < 2 * kSize; ++x) {
    for (int y = 0; y < kSize; ++y) {
      if ((y == 0) == (x < kSize)) {
        inputs_.samples(x, y) = {};
      }
    }
  }
  const ViewEvidence evidence = Gather();
  const int num_measured[] = {90, 10};
  for (int k = 0; k < 2; ++k) {
    SCOPED_TRACE(k);
    const int first = evidence.FirstOfPrior(k);
    ASSERT_GT(first, evidence.first_observation[k]);
    ASSERT_LT(first, evidence.first_observation[k + 1]);
    float own = 0.f;
    float of_prior = 0.f;
    for (int i = evidence.first_observation[k];
         i < evidence.first_observation[k + 1];
         ++i) {
      EXPECT_EQ(evidence.IsOfPrior(i), i >= first);
      (i < first ? own : of_prior) += evidence.observations[i].confidence;
    }
    const float weight =
        0.1f * (1.f - kOutlierShare) * (kNumPixels - num_measured[k]);
    EXPECT_NEAR(of_prior / own, weight / num_measured[k], 1e-3f);
    EXPECT_NEAR(evidence.weights[k], num_measured[k] + weight, 1e-3f);
  }
}

TEST_F(PriorEvidenceTest, HolesOfAPriorTellNothing) {
  Fill(&inputs_.samples, 3, RayDepth{});
  Fill(&inputs_.prior.depth, 3, 0.f);
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.weights[3], 0.f);
  EXPECT_TRUE(ObservationsOf(evidence, 3).empty());
}

TEST_F(PriorEvidenceTest, ThePlaneOfARegionTellsMoreUnlessAPriorContradictsIt) {
  const Plane near = DrawnPlane({0.2f, 0.1f, -1.f}, 5.05f);
  const Plane far = DrawnPlane({0.2f, 0.1f, -1.f}, 5.6f);
  DrawRegionPlane(1, near);
  DrawRegionPlane(2, far);
  MeasureOnePixel(1, near);
  MeasureOnePixel(2, far);
  const ViewEvidence evidence = Gather();
  const std::vector<ObservationSource> agreeing = SourcesOf(evidence, 1);
  EXPECT_GT(Count(agreeing, ObservationSource::kRegionPlane), 25);
  EXPECT_EQ(Count(agreeing, ObservationSource::kPrior), 0);
  const std::vector<ObservationSource> contradicted = SourcesOf(evidence, 2);
  EXPECT_EQ(Count(contradicted, ObservationSource::kRegionPlane), 0);
  EXPECT_EQ(Count(contradicted, ObservationSource::kMeasured), 1);
  EXPECT_EQ(Count(contradicted, ObservationSource::kPrior), 12);
  // An uncertain one does not.
  for (const float sigma : {0.1f, 0.5f}) {
    Fill(&inputs_.prior.sigma, 2, sigma);
    EXPECT_EQ(Count(SourcesOf(Gather(), 2), ObservationSource::kPrior), 0);
  }
}

TEST_F(PriorEvidenceTest, ProposesPlanesAfterThoseOfSuperpixels) {
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.candidates.size(), size_t{2 * kNumSuperpixels});
  EXPECT_EQ(GatherAll().num_region_planes, 0);
  const std::vector<Plane> proposed = ProposePlanesOfPrior(evidence);
  ASSERT_EQ(proposed.size(), size_t{kNumSuperpixels});
  for (int k = 0; k < kNumSuperpixels; ++k) {
    EXPECT_LT(AngleBetween(proposed[k].normal, plane_.normal), 0.1f);
    EXPECT_NEAR(proposed[k].offset, plane_.offset, 0.01f);
    EXPECT_EQ(evidence.candidates[kNumSuperpixels + k].offset,
              proposed[k].offset);
  }
}

TEST_F(PriorEvidenceTest, UncertainPriorsProposeNoPlanes) {
  Fill(&inputs_.prior.sigma, 3, 0.11f);
  Fill(&inputs_.prior.depth, 5, 0.f);
  EXPECT_EQ(ProposePlanesOfPrior(Gather()).size(), size_t{kNumSuperpixels - 2});
  inputs_.prior.sigma = Image<float>(kWidth, kHeight, 0.11f);
  EXPECT_TRUE(ProposePlanesOfPrior(Gather()).empty());
  inputs_.prior = {};
  EXPECT_TRUE(ProposePlanesOfPrior(Gather()).empty());
}

TEST_F(PriorEvidenceTest, ProposedPlanesDoNotMixSurfaces) {
  // A board in front of the plane covers the left half.
  const Plane board = DrawnPlane({-0.1f, 0.f, -1.f}, 4.f);
  const Image<float> on_board = DrawDepth(board, camera_);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth / 2; ++x) {
      inputs_.prior.depth(x, y) = on_board(x, y);
    }
  }
  const std::vector<Plane> proposed = ProposePlanesOfPrior(Gather());
  ASSERT_EQ(proposed.size(), size_t{kNumSuperpixels});
  for (int k = 0; k < kNumSuperpixels; ++k) {
    const Plane& expected = k % kNumColumns < kNumColumns / 2 ? board : plane_;
    EXPECT_LT(AngleBetween(proposed[k].normal, expected.normal), 0.1f) << k;
    EXPECT_NEAR(proposed[k].offset, expected.offset, 0.01f) << k;
  }
}

TEST_F(PriorEvidenceTest, NeighborsThatContinueAPlaneMakeItMorePrecise) {
  Philox random(12, 0, 0);
  for (float& depth : inputs_.prior.depth) {
    depth *= 1.f + static_cast<float>(0.003 * NextNormal(&random));
  }
  ViewEvidence evidence = Gather();
  const auto sum_of_angles = [&] {
    float sum = 0.f;
    for (const Plane& plane : ProposePlanesOfPrior(evidence)) {
      sum += AngleBetween(plane.normal, plane_.normal);
    }
    return sum;
  };
  const float joint = sum_of_angles();
  evidence.borders.clear();
  EXPECT_LT(joint, 0.7f * sum_of_angles());
}

}  // namespace
}  // namespace tsar
