// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <vector>

#include "tests/scene/evidence/gather_evidence_fixture.h"
#include "tests/support/synthetic_observations.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(GatherEvidenceTest, KeepsTheRasterAndItsScale) {
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.width, kWidth);
  EXPECT_EQ(evidence.height, kHeight);
  EXPECT_EQ(evidence.intrinsics.fx, inputs_.intrinsics.fx);
  EXPECT_EQ(evidence.intrinsics.fy, inputs_.intrinsics.fy);
  EXPECT_EQ(evidence.intrinsics.cx, inputs_.intrinsics.cx);
  EXPECT_EQ(evidence.intrinsics.cy, inputs_.intrinsics.cy);
  EXPECT_EQ(evidence.resolution.error_per_depth, 0.001f);
  EXPECT_EQ(evidence.NumSuperpixels(), kNumSuperpixels);
  EXPECT_EQ(evidence.first_observation.size(), kNumSuperpixels + 1u);
  EXPECT_TRUE(std::equal(evidence.superpixels.begin(),
                         evidence.superpixels.end(),
                         inputs_.superpixels.begin(),
                         inputs_.superpixels.end()));
  EXPECT_TRUE(evidence.flags.Empty());
}

TEST_F(GatherEvidenceTest, WeighsPixelsByHowTheirDepthIsKnown) {
  Fill(&inputs_.texture, 1, 0.9f);
  const Plane region = DrawnPlane({0.f, 0.1f, -1.f}, 7.f);
  for (const int superpixel : {0, 1, 3}) {
    DrawRegionPlane(superpixel, region);
  }
  Fill(&inputs_.samples, 3, RayDepth{});
  const ViewEvidence evidence = Gather();
  const float confidences[] = {1.f, 0.5f};
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(evidence.weights[k], kNumPixels * confidences[k], 1e-3f);
    const std::vector<Observation> observations = ObservationsOf(evidence, k);
    EXPECT_EQ(observations.size(), 32u);
    for (const Observation& observation : observations) {
      EXPECT_EQ(observation.confidence, confidences[k]);
      EXPECT_NEAR(RelativeDistance(plane_, observation.sample), 0.f, 1e-6f);
    }
  }
  // The plane of a region counts only where something was measured.
  EXPECT_EQ(evidence.weights[3], 0.f);
  EXPECT_TRUE(ObservationsOf(evidence, 3).empty());
  // After a superpixel without observations, the next still has its own.
  EXPECT_EQ(ObservationsOf(evidence, 4).size(), 32u);
}

TEST_F(GatherEvidenceTest, WeighsMeasurementsByTheirFatteningWeight) {
  const ViewEvidence without = Gather();
  inputs_.fattening_weight = Image<float>(kWidth, kHeight, 1.f);
  EXPECT_EQ(Gather().weights, without.weights);
  Fill(&inputs_.fattening_weight, 1, 0.6f);
  Fill(&inputs_.fattening_weight, 2, 0.1f);
  Fill(&inputs_.fattening_weight, 3, 0.f);
  // Together with weak texture.
  Fill(&inputs_.fattening_weight, 4, 0.6f);
  Fill(&inputs_.texture, 4, 0.9f);
  Fill(&inputs_.fattening_weight, 5, 0.f);
  Fill(&inputs_.texture, 5, 0.9f);
  const ViewEvidence evidence = Gather();
  const float confidences[] = {1.f, 0.36f, 0.02f, 0.02f, 0.18f, 0.01f};
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(evidence.weights[k], kNumPixels * confidences[k], 1e-3f);
    for (const Observation& observation : ObservationsOf(evidence, k)) {
      EXPECT_NEAR(observation.confidence, confidences[k], 1e-6f);
    }
    EXPECT_EQ(ObservationsOf(evidence, k).size(), 32u);
  }
}

TEST_F(GatherEvidenceTest, FillsCountByTheMeasurementsThatLieOnThem) {
  inputs_.fattening_weight = Image<float>(kWidth, kHeight, 1.f);
  // A tenth of the pixels of each superpixel is measured; the region's plane,
  // some multiple of the error behind it, fills the rest.
  const float u = inputs_.resolution.RelativeDepthError(5.f);
  const Plane wall = DrawnPlane({0.f, 0.f, -1.f}, 5.f);
  const Image<RayDepth> on_wall = ToSamples(DrawDepth(wall, camera_), camera_);
  const float residuals[] = {0.f, 5.9f, 6.1f, 40.f, 40.f, 40.f};
  for (int k = 0; k < 6; ++k) {
    DrawRegionPlane(k,
                    DrawnPlane({0.f, 0.f, -1.f}, 5.f * (1 + residuals[k] * u)));
  }
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      inputs_.samples(x, y) = y % kSize == 0 ? on_wall(x, y) : RayDepth{};
    }
  }
  // The fourth superpixel's own depths are fattened, and the texture of the
  // fifth is weak. Half of the last one's are on the plane.
  Fill(&inputs_.fattening_weight, 3, 0.f);
  Fill(&inputs_.texture, 4, 0.9f);
  for (int x = 0; x < kSize / 2; ++x) {
    const int first_x = 5 % kNumColumns * kSize;
    const int first_y = 5 / kNumColumns * kSize;
    inputs_.samples(first_x + x, first_y).z *= 1 + 40 * u;
  }
  const ViewEvidence evidence = Gather();
  const float shares[] = {1.f, 1.f, 0.f, 0.f, 0.f, 0.5f};
  const float measured[] = {10.f, 10.f, 10.f, 0.2f, 5.f, 10.f};
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(evidence.weights[k], measured[k] + 90 * 0.3f * shares[k], 1e-3f)
        << k;
    if (shares[k] > 0.f) {
      EXPECT_NEAR(ObservationsOf(evidence, k).back().confidence,
                  0.3f * shares[k],
                  1e-6f)
          << k;
    }
  }
}

TEST_F(GatherEvidenceTest, TellsMeasurementsFromDepthsOfTheRegionsPlane) {
  DrawRegionPlane(3, plane_);
  RayDepth* samples = inputs_.samples.Data();
  for (int y = 0; y < kSize; ++y) {
    for (int x = 3 * kSize; x < 4 * kSize; ++x) {
      if (x % 2 == 0) {
        samples[y * kWidth + x].z = 0.f;
      }
    }
  }
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.sources.size(), evidence.observations.size());
  EXPECT_TRUE(evidence.errors.empty());
  int num_filled = 0;
  for (size_t i = 0; i < evidence.observations.size(); ++i) {
    const bool is_filled = evidence.observations[i].confidence < 0.5f;
    EXPECT_EQ(evidence.sources[i],
              is_filled ? ObservationSource::kRegionPlane
                        : ObservationSource::kMeasured);
    num_filled += is_filled ? 1 : 0;
  }
  EXPECT_GT(num_filled, 5);
}

TEST_F(GatherEvidenceTest, KeepsConfirmedDepthsThatWereNotTrusted) {
  inputs_.confirmed_samples = inputs_.samples;
  Fill(&inputs_.samples, 2, RayDepth{});
  RayDepth* samples = inputs_.samples.Data();
  samples[0] = {};  // One pixel of the first superpixel.
  const ViewEvidence evidence = Gather();
  std::vector<int> counts(kNumSuperpixels, 0);
  counts[0] = 1;
  counts[2] = kNumPixels;
  EXPECT_EQ(evidence.confirmed_pixels, counts);
  ASSERT_EQ(evidence.first_confirmed.size(), counts.size() + 1);
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(evidence.first_confirmed[s + 1] - evidence.first_confirmed[s],
              std::min(counts[s], kMaxConfirmedPerSuperpixel));
  }
  for (const RayDepth& sample : evidence.confirmed) {
    EXPECT_NEAR(plane_.Depth({sample.x, sample.y, 1.f}), sample.z, 1e-4f);
  }
  // They are no observations.
  EXPECT_TRUE(ObservationsOf(evidence, 2).empty());
}

TEST_F(GatherEvidenceTest, SpreadsObservationsOverTheSuperpixel) {
  std::vector<int> count(kNumSuperpixels, 0);
  for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
    inputs_.samples.Data()[i].z =
        static_cast<float>(++count[inputs_.superpixels.Data()[i]]);
  }
  // Only the first 31 samples of superpixel 0 and 33 of superpixel 1 stay.
  for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
    RayDepth& sample = inputs_.samples.Data()[i];
    const int superpixel = inputs_.superpixels.Data()[i];
    if ((superpixel == 0 && sample.z > 31.f) ||
        (superpixel == 1 && sample.z > 33.f)) {
      sample = RayDepth{};
    }
  }
  const ViewEvidence evidence = Gather();
  const std::vector<Observation> all = ObservationsOf(evidence, 0);
  ASSERT_EQ(all.size(), 31u);
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].sample.z, i + 1.f);
  }
  EXPECT_EQ(ObservationsOf(evidence, 1).size(), 32u);
  const std::vector<Observation> some = ObservationsOf(evidence, 2);
  ASSERT_EQ(some.size(), 32u);
  EXPECT_LE(some.front().sample.z, 3.f);
  EXPECT_GE(some.back().sample.z, 98.f);
  for (size_t i = 1; i < some.size(); ++i) {
    EXPECT_GE(some[i].sample.z - some[i - 1].sample.z, 3.f);
    EXPECT_LE(some[i].sample.z - some[i - 1].sample.z, 4.f);
  }
}

TEST_F(GatherEvidenceTest, ObservesRegionPlanesOnlyBeforeTheCamera) {
  // The rays of the left half of the superpixel meet it behind the camera.
  const float x = inputs_.intrinsics.Ray(4.5f, 0.f).x;
  const Plane plane{Normalized({-1.f, 0.f, x}), 1.f};
  DrawRegionPlane(0, plane);
  // One pixel is measured, on the plane.
  Fill(&inputs_.samples, 0, RayDepth{});
  RayDepth& sample = inputs_.samples(kSize - 1, 0);
  const Vec3f ray = inputs_.intrinsics.Ray(kSize - 1.f, 0.f);
  sample = {ray.x, ray.y, plane.Depth(ray)};
  const ViewEvidence evidence = Gather();
  EXPECT_NEAR(evidence.weights[0], 1.f + 0.3f * (kNumPixels / 2 - 1), 1e-3f);
  for (const Observation& observation : ObservationsOf(evidence, 0)) {
    EXPECT_GT(observation.sample.x, x);
  }
}

TEST_F(GatherEvidenceTest, NoiseIsTheSpreadAboutTheSuperpixelsPlanes) {
  EXPECT_NEAR(Gather().noise, 0.f, 1e-3f);
  Philox random(4, 0, 0);
  for (RayDepth& sample : inputs_.samples) {
    sample.z *= 1.f + 0.7f * inputs_.resolution.RelativeDepthError(sample.z) *
                          static_cast<float>(NextNormal(&random));
  }
  EXPECT_NEAR(Gather().noise, 0.7f, 0.05f);
  // A fifth of the depths are wrong, which hardly affects the median.
  for (size_t i = 0; i < inputs_.samples.NumPixels(); i += 5) {
    inputs_.samples.Data()[i].z *= 3.f;
  }
  EXPECT_NEAR(Gather().noise, 0.9f, 0.1f);
}

TEST_F(GatherEvidenceTest, CandidatesArePlanesOfRegionsThenOfSuperpixels) {
  const Plane first = DrawnPlane({0.f, 0.1f, -1.f}, 7.f);
  const Plane second = DrawnPlane({0.1f, 0.f, -1.f}, 8.f);
  const Plane small = DrawnPlane({0.f, 0.f, -1.f}, 9.f);
  // The first has two places and the small one 29 pixels, all of which come
  // before the second.
  DrawRegionPlane(0, first);
  DrawRegionPlane(2, second);
  DrawRegionPlane(7, first);
  for (int i = 0; i < 29; ++i) {
    inputs_.region_planes(10 + i % 10, i / 10) = small;
  }
  for (int k = 0; k < kNumSuperpixels; ++k) {
    inputs_.superpixel_planes[k] = k == 3   ? DrawnPlane({0.f, 0.f, -1.f}, 3.f)
                                   : k == 9 ? DrawnPlane({0.f, 0.f, -1.f}, 4.f)
                                            : Plane{};
  }
  const GatheredEvidence gathered = GatherAll();
  const ViewEvidence& evidence = gathered.evidence;
  EXPECT_EQ(gathered.num_region_planes, 2);
  ASSERT_EQ(evidence.candidates.size(), 4u);
  EXPECT_EQ(evidence.candidates[0].offset, first.offset);
  EXPECT_EQ(evidence.candidates[1].offset, second.offset);
  EXPECT_EQ(evidence.candidates[2].offset, 3.f);
  EXPECT_EQ(evidence.candidates[3].offset, 4.f);
  // With one more pixel it is one of them, after the first.
  inputs_.region_planes(19, 2) = small;
  const GatheredEvidence with_small = GatherAll();
  EXPECT_EQ(with_small.num_region_planes, 3);
  ASSERT_EQ(with_small.evidence.candidates.size(), 5u);
  EXPECT_EQ(with_small.evidence.candidates[1].offset, small.offset);
}

TEST_F(GatherEvidenceTest, OnlyTexturedDepthsAreConfident) {
  Fill(&inputs_.texture, 1, 0.9f);
  Fill(&inputs_.samples, 2, RayDepth{});
  DrawRegionPlane(2, plane_);
  const ViewEvidence evidence = Gather();
  for (size_t i = 0; i < evidence.confident_depth.NumPixels(); ++i) {
    const int superpixel = inputs_.superpixels.Data()[i];
    EXPECT_EQ(
        evidence.confident_depth.Data()[i],
        superpixel == 1 || superpixel == 2 ? 0.f : inputs_.samples.Data()[i].z);
  }
}

TEST_F(GatherEvidenceTest, TakesDepthsThatAreNotFiniteForNone) {
  for (const float depth : {kNan, kInfinity, -1.f}) {
    Fill(&inputs_.samples, 0, RayDepth{0.f, 0.f, depth});
    const ViewEvidence evidence = Gather();
    EXPECT_EQ(evidence.weights[0], 0.f);
    EXPECT_TRUE(ObservationsOf(evidence, 0).empty());
    EXPECT_EQ(evidence.confident_depth(3, 3), 0.f);
    EXPECT_NEAR(evidence.noise, 0.f, 1e-3f);
  }
}

TEST_F(GatherEvidenceTest, PlanesThatAreNotFiniteAreNone) {
  DrawRegionPlane(0, Plane{{kNan, 0.f, -1.f}, 5.f});
  DrawRegionPlane(1, Plane{{0.f, 0.f, -1.f}, kNan});
  Fill(&inputs_.samples, 0, RayDepth{});
  Fill(&inputs_.samples, 1, RayDepth{});
  inputs_.superpixel_planes[2] = Plane{{0.f, 0.f, -1.f}, kNan};
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.weights[0], 0.f);
  EXPECT_EQ(evidence.weights[1], 0.f);
  EXPECT_NEAR(evidence.noise, 0.f, 1e-3f);
}

TEST_F(GatherEvidenceTest, TakesOneSuperpixelAndNone) {
  std::fill(inputs_.superpixels.begin(), inputs_.superpixels.end(), 0);
  inputs_.num_superpixels = 1;
  inputs_.superpixel_planes.resize(1);
  const ViewEvidence evidence = Gather();
  EXPECT_TRUE(evidence.borders.empty());
  EXPECT_EQ(evidence.weights[0], kWidth * kHeight);
  EXPECT_EQ(evidence.observations.size(), 32u);

  const ViewEvidence empty = GatherEvidence({}).evidence;
  EXPECT_EQ(empty.NumSuperpixels(), 0);
  EXPECT_EQ(empty.first_observation, std::vector<int>{0});
}

}  // namespace
}  // namespace tsar
