// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/gather_evidence.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "tests/support/drawn_observations.h"
#include "tests/support/drawn_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr int kSize = 10;  // Of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumSuperpixels = kNumColumns * kHeight / kSize;
constexpr int kNumPixels = kSize * kSize;  // Of a superpixel.
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// Square superpixels, numbered row by row, on a well textured plane that is
// measured everywhere.
class GatherEvidenceTest : public testing::Test {
 protected:
  GatherEvidenceTest()
      : camera_(DrawnCamera(kWidth, kHeight, 40.0)),
        plane_(DrawnPlane({0.2f, 0.1f, -1.f}, 5.f)) {
    inputs_.superpixels = Image<int>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        inputs_.superpixels(x, y) = y / kSize * kNumColumns + x / kSize;
      }
    }
    inputs_.num_superpixels = kNumSuperpixels;
    inputs_.superpixel_planes.assign(kNumSuperpixels, plane_);
    inputs_.samples = ToSamples(DrawDepth(plane_, camera_), camera_);
    inputs_.texture = Image<float>(kWidth, kHeight, 5.f);
    inputs_.contrast = Image<float>(kWidth, kHeight, 0.f);
    inputs_.intrinsics = camera_.GetIntrinsics();
    inputs_.resolution.error_per_depth = 0.001f;
  }

  ViewEvidence Gather() const { return GatherEvidence(inputs_, options_); }

  template <typename T>
  void Fill(Image<T>* image, int superpixel, const T& value) const {
    for (size_t i = 0; i < image->NumPixels(); ++i) {
      if (inputs_.superpixels.Data()[i] == superpixel) {
        image->Data()[i] = value;
      }
    }
  }

  void DrawRegionPlane(int superpixel, const Plane& plane) {
    if (inputs_.region_planes.Empty()) {
      inputs_.region_planes = Image<Plane>(kWidth, kHeight);
    }
    Fill(&inputs_.region_planes, superpixel, plane);
  }

  static std::vector<Observation> ObservationsOf(const ViewEvidence& evidence,
                                                 int superpixel) {
    return {
        evidence.observations.begin() + evidence.first_observation[superpixel],
        evidence.observations.begin() +
            evidence.first_observation[superpixel + 1]};
  }

  static const SuperpixelBorder& BorderOf(const ViewEvidence& evidence,
                                          int first,
                                          int second) {
    return *std::find_if(evidence.borders.begin(),
                         evidence.borders.end(),
                         [&](const SuperpixelBorder& border) {
                           return border.first == first &&
                                  border.second == second;
                         });
  }

  const Camera camera_;
  const Plane plane_;
  EvidenceInputs inputs_;
  const EvidenceOptions options_;
};

TEST_F(GatherEvidenceTest, KeepsTheRasterAndItsScale) {
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.width, kWidth);
  EXPECT_EQ(evidence.height, kHeight);
  EXPECT_EQ(evidence.resolution.error_per_depth, 0.001f);
  EXPECT_EQ(evidence.NumSuperpixels(), kNumSuperpixels);
  EXPECT_EQ(evidence.first_observation.size(), kNumSuperpixels + 1u);
  EXPECT_TRUE(std::equal(evidence.superpixels.begin(),
                         evidence.superpixels.end(),
                         inputs_.superpixels.begin(),
                         inputs_.superpixels.end()));
  EXPECT_TRUE(evidence.trust.Empty());
}

TEST_F(GatherEvidenceTest, WeighsPixelsByHowTheirDepthIsKnown) {
  Fill(&inputs_.texture, 1, 0.9f);
  const Plane region = DrawnPlane({0.f, 0.1f, -1.f}, 7.f);
  for (const int superpixel : {0, 1, 2}) {
    DrawRegionPlane(superpixel, region);
  }
  Fill(&inputs_.samples, 2, RayDepth{});
  Fill(&inputs_.samples, 3, RayDepth{});
  const ViewEvidence evidence = Gather();
  const float qualities[] = {1.f, 0.5f, 0.3f};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(evidence.mass[k], kNumPixels * qualities[k], 1e-3f);
    const std::vector<Observation> observations = ObservationsOf(evidence, k);
    EXPECT_EQ(observations.size(), 32u);
    for (const Observation& observation : observations) {
      EXPECT_EQ(observation.quality, qualities[k]);
      EXPECT_NEAR(
          RelativeDistance(k == 2 ? region : plane_, observation.sample),
          0.f,
          1e-6f);
    }
  }
  EXPECT_EQ(evidence.mass[3], 0.f);
  EXPECT_TRUE(ObservationsOf(evidence, 3).empty());
  // After one without observations the next still has its own.
  EXPECT_EQ(ObservationsOf(evidence, 4).size(), 32u);
}

TEST_F(GatherEvidenceTest, WeighsMeasurementsByTheirOwnTexture) {
  const ViewEvidence without = Gather();
  inputs_.own_texture = Image<float>(kWidth, kHeight, 1.f);
  EXPECT_EQ(Gather().mass, without.mass);
  Fill(&inputs_.own_texture, 1, 0.6f);
  Fill(&inputs_.own_texture, 2, 0.1f);
  Fill(&inputs_.own_texture, 3, 0.f);
  // Together with weak texture.
  Fill(&inputs_.own_texture, 4, 0.6f);
  Fill(&inputs_.texture, 4, 0.9f);
  Fill(&inputs_.own_texture, 5, 0.f);
  Fill(&inputs_.texture, 5, 0.9f);
  // Of no effect where nothing was measured.
  Fill(&inputs_.own_texture, 6, 0.f);
  Fill(&inputs_.samples, 6, RayDepth{});
  DrawRegionPlane(6, plane_);
  const ViewEvidence evidence = Gather();
  const float qualities[] = {1.f, 0.36f, 0.02f, 0.02f, 0.18f, 0.01f, 0.3f};
  for (int k = 0; k < 7; ++k) {
    EXPECT_NEAR(evidence.mass[k], kNumPixels * qualities[k], 1e-3f);
    for (const Observation& observation : ObservationsOf(evidence, k)) {
      EXPECT_NEAR(observation.quality, qualities[k], 1e-6f);
    }
    EXPECT_EQ(ObservationsOf(evidence, k).size(), 32u);
  }
  EvidenceOptions options;
  options.min_own_quality = 0.5f;
  EXPECT_NEAR(
      GatherEvidence(inputs_, options).mass[1], kNumPixels * 0.5f, 1e-3f);
}

TEST_F(GatherEvidenceTest, SpreadsObservationsOverTheSuperpixel) {
  std::vector<int> count(kNumSuperpixels, 0);
  for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
    inputs_.samples.Data()[i].z =
        static_cast<float>(++count[inputs_.superpixels.Data()[i]]);
  }
  // Of superpixel 0 just the first 31 are left, of superpixel 1 the first 33.
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
  Fill(&inputs_.samples, 0, RayDepth{});
  // The rays of the left half of the superpixel meet it behind the camera.
  const float x = inputs_.intrinsics.Ray(4.5f, 0.f).x;
  const Plane plane{Normalized({-1.f, 0.f, x}), 1.f};
  DrawRegionPlane(0, plane);
  const ViewEvidence evidence = Gather();
  EXPECT_NEAR(evidence.mass[0], 0.3f * kNumPixels / 2, 1e-3f);
  for (const Observation& observation : ObservationsOf(evidence, 0)) {
    EXPECT_GT(observation.sample.x, x);
  }
}

TEST_F(GatherEvidenceTest, BordersAreWeakWhereTheImageHasAnEdge) {
  // On one side of the border between 1 and 2 alone.
  Fill(&inputs_.contrast, 2, 8.f);
  const ViewEvidence evidence = Gather();
  EXPECT_NEAR(BorderOf(evidence, 0, 1).weight, kSize * 2.05f, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 0, 4).weight, kSize * 2.05f, 1e-3f);
  const float at_edge = kSize * (0.05f + 2.f * std::exp(-2.f));
  EXPECT_NEAR(BorderOf(evidence, 1, 2).weight, at_edge, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 2, 3).weight, at_edge, 1e-3f);
  EXPECT_NEAR(BorderOf(evidence, 2, 6).weight, at_edge, 1e-3f);
}

TEST_F(GatherEvidenceTest, BordersAreSortedAndHoldEachPairOnce) {
  for (const bool is_reversed : {false, true}) {
    for (int& label : inputs_.superpixels) {
      label = is_reversed ? kNumSuperpixels - 1 - label : label;
    }
    const ViewEvidence evidence = Gather();
    // Between columns and between rows.
    EXPECT_EQ(evidence.borders.size(), 3u * 3u + 4u * 2u);
    for (size_t i = 0; i < evidence.borders.size(); ++i) {
      const SuperpixelBorder& border = evidence.borders[i];
      EXPECT_LT(border.first, border.second);
      if (i > 0) {
        const SuperpixelBorder& last = evidence.borders[i - 1];
        EXPECT_LT(std::pair(last.first, last.second),
                  std::pair(border.first, border.second));
      }
    }
  }
}

TEST_F(GatherEvidenceTest, BordersOfOneWithManyAreSorted) {
  // Superpixel 0 is a row above all others, which are columns of it.
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      inputs_.superpixels(x, y) = y == 0 ? 0 : 1 + x * 7 % kWidth;
    }
  }
  inputs_.num_superpixels = kWidth + 1;
  inputs_.superpixel_planes.assign(kWidth + 1, plane_);
  const ViewEvidence evidence = Gather();
  for (int k = 1; k <= kWidth; ++k) {
    EXPECT_EQ(evidence.borders[k - 1].first, 0);
    EXPECT_EQ(evidence.borders[k - 1].second, k);
  }
}

TEST_F(GatherEvidenceTest, BordersKeepPixelsOnTheSideOfTheFirst) {
  const std::array<int, 4> spaced = {1, 3, 6, 8};
  const ViewEvidence evidence = Gather();
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    EXPECT_EQ(BorderOf(evidence, 0, 1).pixels[i], spaced[i] * kWidth + 9);
    EXPECT_EQ(BorderOf(evidence, 0, 4).pixels[i], 9 * kWidth + spaced[i]);
  }
  for (int& label : inputs_.superpixels) {
    label = kNumSuperpixels - 1 - label;
  }
  const ViewEvidence reversed = Gather();
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    EXPECT_EQ(BorderOf(reversed, 10, 11).pixels[i], spaced[i] * kWidth + 10);
    EXPECT_EQ(BorderOf(reversed, 7, 11).pixels[i], 10 * kWidth + spaced[i]);
  }
}

TEST_F(GatherEvidenceTest, ShortBordersRepeatTheirPixels) {
  std::fill(inputs_.superpixels.begin(), inputs_.superpixels.end(), 0);
  inputs_.superpixels(0, 0) = 1;
  inputs_.num_superpixels = 2;
  inputs_.superpixel_planes.resize(2);
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.borders.size(), 1u);
  for (const int pixel : evidence.borders[0].pixels) {
    EXPECT_TRUE(pixel == 1 || pixel == kWidth) << pixel;
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
  // A fifth of the depths are wrong, which the median hardly feels.
  for (size_t i = 0; i < inputs_.samples.NumPixels(); i += 5) {
    inputs_.samples.Data()[i].z *= 3.f;
  }
  EXPECT_NEAR(Gather().noise, 0.9f, 0.1f);
}

TEST_F(GatherEvidenceTest, NoiseLeavesOutSuperpixelsWithoutPlanes) {
  for (int k = 1; k < kNumSuperpixels; ++k) {
    inputs_.superpixel_planes[k] = Plane{};
    Fill(&inputs_.samples, k, RayDepth{0.1f, 0.1f, 30.f});
  }
  EXPECT_NEAR(Gather().noise, 0.f, 1e-3f);
  inputs_.superpixel_planes[0] = Plane{};
  const ViewEvidence evidence = Gather();
  EXPECT_EQ(evidence.noise, 0.f);
  EXPECT_TRUE(evidence.candidates.empty());
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
  const ViewEvidence evidence = Gather();
  ASSERT_EQ(evidence.candidates.size(), 4u);
  EXPECT_EQ(evidence.candidates[0].offset, first.offset);
  EXPECT_EQ(evidence.candidates[1].offset, second.offset);
  EXPECT_EQ(evidence.candidates[2].offset, 3.f);
  EXPECT_EQ(evidence.candidates[3].offset, 4.f);
  for (size_t i = 0; i < evidence.region_planes.NumPixels(); ++i) {
    const int superpixel = inputs_.superpixels.Data()[i];
    EXPECT_EQ(evidence.region_planes.Data()[i],
              superpixel == 0 || superpixel == 7 ? 1
              : superpixel == 2                  ? 2
                                                 : 0);
  }
  // With one more pixel it is one of them, after the first.
  inputs_.region_planes(19, 2) = small;
  const ViewEvidence with_small = Gather();
  ASSERT_EQ(with_small.candidates.size(), 5u);
  EXPECT_EQ(with_small.candidates[1].offset, small.offset);
  EXPECT_EQ(with_small.region_planes(19, 2), 2);
  EXPECT_EQ(with_small.region_planes(20, 2), 3);
}

TEST_F(GatherEvidenceTest, SmallRegionPlanesAreNoObservations) {
  Fill(&inputs_.samples, 0, RayDepth{});
  inputs_.region_planes = Image<Plane>(kWidth, kHeight);
  inputs_.region_planes(3, 3) = plane_;
  EXPECT_EQ(Gather().mass[0], 0.f);
}

TEST_F(GatherEvidenceTest, OnlyTexturedDepthsAreStrong) {
  Fill(&inputs_.texture, 1, 0.9f);
  Fill(&inputs_.samples, 2, RayDepth{});
  DrawRegionPlane(2, plane_);
  const ViewEvidence evidence = Gather();
  for (size_t i = 0; i < evidence.strong_depth.NumPixels(); ++i) {
    const int superpixel = inputs_.superpixels.Data()[i];
    EXPECT_EQ(
        evidence.strong_depth.Data()[i],
        superpixel == 1 || superpixel == 2 ? 0.f : inputs_.samples.Data()[i].z);
  }
}

TEST_F(GatherEvidenceTest, TakesDepthsThatAreNotFiniteForNone) {
  for (const float depth : {kNan, kInfinity, -1.f}) {
    Fill(&inputs_.samples, 0, RayDepth{0.f, 0.f, depth});
    const ViewEvidence evidence = Gather();
    EXPECT_EQ(evidence.mass[0], 0.f);
    EXPECT_TRUE(ObservationsOf(evidence, 0).empty());
    EXPECT_EQ(evidence.strong_depth(3, 3), 0.f);
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
  EXPECT_EQ(evidence.mass[0], 0.f);
  EXPECT_EQ(evidence.mass[1], 0.f);
  EXPECT_NEAR(evidence.noise, 0.f, 1e-3f);
}

TEST_F(GatherEvidenceTest, TakesViewsWithoutSamples) {
  std::fill(inputs_.samples.begin(), inputs_.samples.end(), RayDepth{});
  const ViewEvidence evidence = Gather();
  EXPECT_TRUE(evidence.observations.empty());
  EXPECT_EQ(evidence.first_observation,
            std::vector<int>(kNumSuperpixels + 1, 0));
  EXPECT_EQ(evidence.noise, 0.f);
  EXPECT_EQ(evidence.region_planes.NumPixels(), inputs_.samples.NumPixels());
  EXPECT_EQ(
      std::accumulate(
          evidence.region_planes.begin(), evidence.region_planes.end(), 0),
      0);
}

TEST_F(GatherEvidenceTest, TakesOneSuperpixelAndNone) {
  std::fill(inputs_.superpixels.begin(), inputs_.superpixels.end(), 0);
  inputs_.num_superpixels = 1;
  inputs_.superpixel_planes.resize(1);
  const ViewEvidence evidence = Gather();
  EXPECT_TRUE(evidence.borders.empty());
  EXPECT_EQ(evidence.mass[0], kWidth * kHeight);
  EXPECT_EQ(evidence.observations.size(), 32u);

  const ViewEvidence empty = GatherEvidence({}, options_);
  EXPECT_EQ(empty.NumSuperpixels(), 0);
  EXPECT_EQ(empty.first_observation, std::vector<int>{0});
}

}  // namespace
}  // namespace tsar
