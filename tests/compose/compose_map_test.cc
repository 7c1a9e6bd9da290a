// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_map.h"

#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/refined_maps.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr Vec3f kOwnNormal{0.f, 0.f, -1.f};
constexpr Vec3f kSuperpixelNormal{0.f, 0.6f, -0.8f};
constexpr Vec3f kRegionNormal{0.6f, 0.f, -0.8f};

struct Composed {
  float depth = 0.f;
  Vec3f normal;
  Provenance provenance = Provenance::kNone;
};

// One pixel. Depths near 4 are of one surface if they differ by at most 1 %.
class ComposeTest : public testing::Test {
 protected:
  ComposeTest() : device_(CreateTestDevice(1)) {
    scale_.error_per_depth = 0.0025f;
  }

  // Depths; 0 stands for none.
  Composed Compose(float own, bool trusted, float superpixel, float region) {
    const Image<Plane> superpixel_plane =
        PlaneAt(superpixel, kSuperpixelNormal);
    const Image<Plane> region_plane = PlaneAt(region, kRegionNormal);
    const Image<uint8_t> mask(1, 1, trusted ? 1 : 0);
    const ComposedMap map = ComposeMap(
        OwnMap(own),
        {on_device_(mask), Raster(superpixel_plane), Raster(region_plane)},
        scale_,
        *device_);
    return {map.map.depth.ToHost()(0, 0),
            map.map.normal.ToHost()(0, 0),
            static_cast<Provenance>(map.provenance.ToHost()(0, 0))};
  }
  DepthNormalImages OwnMap(float depth) const {
    DepthNormalImages own;
    own.depth = DeviceImage<float>(*device_, Image<float>(1, 1, depth));
    own.normal = DeviceImage<Vec3f>(
        *device_, Image<Vec3f>(1, 1, depth > 0.f ? kOwnNormal : Vec3f{}));
    return own;
  }
  static Image<Plane> PlaneAt(float depth, const Vec3f& normal) {
    return Image<Plane>(1,
                        1,
                        depth > 0.f
                            ? Plane::FromPoint({0.f, 0.f, 1.f}, depth, normal)
                            : Plane());
  }
  PlaneRaster Raster(const Image<Plane>& planes) {
    return {on_device_(planes), Intrinsics{1.f, 1.f, 0.f, 0.f}, 1, 1};
  }
  static void Expect(const Composed& composed,
                     float depth,
                     const Vec3f& normal,
                     Provenance provenance) {
    EXPECT_FLOAT_EQ(composed.depth, depth);
    EXPECT_EQ(composed.normal, normal);
    EXPECT_EQ(composed.provenance, provenance);
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  DisparityScale scale_;
};

TEST_F(ComposeTest, MeasurementsMoveOntoThePlaneTheyLieOn) {
  Expect(Compose(4.f, true, 4.02f, 0.f),
         4.02f,
         kSuperpixelNormal,
         Provenance::kMeasured);
  Expect(Compose(4.f, true, 0.f, 4.02f),
         4.02f,
         kRegionNormal,
         Provenance::kMeasured);
  // The larger plane is the better known one.
  Expect(Compose(4.f, true, 4.01f, 3.98f),
         3.98f,
         kRegionNormal,
         Provenance::kMeasured);
}

TEST_F(ComposeTest, MeasurementsOffThePlanesKeepTheirDepth) {
  Expect(
      Compose(4.f, true, 4.1f, 3.9f), 4.f, kOwnNormal, Provenance::kMeasured);
  Expect(Compose(4.f, true, 0.f, 0.f), 4.f, kOwnNormal, Provenance::kMeasured);
  // Off one plane and on the other.
  Expect(Compose(4.f, true, 4.02f, 5.f),
         4.02f,
         kSuperpixelNormal,
         Provenance::kMeasured);
}

TEST_F(ComposeTest, WhatIsNotTrustedHasNoSay) {
  for (const float own : {0.f, 4.f, 5.f}) {
    Expect(Compose(own, false, 0.f, 0.f), 0.f, {}, Provenance::kNone);
    Expect(Compose(own, false, 5.f, 0.f),
           5.f,
           kSuperpixelNormal,
           Provenance::kSuperpixelPlane);
    Expect(Compose(own, false, 0.f, 5.f),
           5.f,
           kRegionNormal,
           Provenance::kRegionPlane);
  }
}

TEST_F(ComposeTest, TheSuperpixelWinsUnlessTheRegionSaysTheSame) {
  Expect(Compose(0.f, false, 5.f, 6.f),
         5.f,
         kSuperpixelNormal,
         Provenance::kSuperpixelPlane);
  Expect(Compose(0.f, false, 5.f, 5.02f),
         5.02f,
         kRegionNormal,
         Provenance::kRegionPlane);
}

TEST_F(ComposeTest, AConfirmedDepthStandsWithoutTrust) {
  const Image<uint8_t> trusted(1, 1, 0);
  const Image<Plane> planes(1, 1, Plane{{0.f, 0.f, -1.f}, 5.f});
  const PlaneRaster region = Raster(planes);
  for (const Confirmation confirmation :
       {Confirmation::kNone, Confirmation::kWeak, Confirmation::kDistinct}) {
    const Image<uint8_t> confirmations(
        1, 1, static_cast<uint8_t>(confirmation));
    const ComposedMap map =
        ComposeMap(OwnMap(4.f),
                   {on_device_(trusted), {}, region, on_device_(confirmations)},
                   scale_,
                   *device_);
    EXPECT_EQ(map.map.depth.ToHost()(0, 0),
              confirmation == Confirmation::kNone ? 5.f : 4.f);
  }
}

// The confidence of each provenance, in the order of their numbers.
std::vector<float> Confidences(float score, Device& device) {
  constexpr int kCount = 5;
  Image<uint8_t> provenance(kCount, 1);
  for (int i = 0; i < kCount; ++i) {
    provenance(i, 0) = static_cast<uint8_t>(i);
  }
  const ComposedMap map{DepthNormalImages(device, kCount, 1),
                        DeviceImage<uint8_t>(device, provenance)};
  const Image<float> scores(kCount, 1, score);
  const Image<float> confidence =
      ComputeComposedConfidence(map, DeviceCopies(device)(scores), device)
          .ToHost();
  return {confidence.begin(), confidence.end()};
}

TEST_F(ComposeTest, FilledPixelsAreWorthLessThanTrustedOnes) {
  // The least score that the filter lets pass by default.
  const auto score = static_cast<float>(RefineOptions().min_aggregated_score);
  const std::vector<float> values = Confidences(score, *device_);
  const float measured = values[static_cast<size_t>(Provenance::kMeasured)];
  for (const Provenance provenance : {Provenance::kSuperpixelPlane,
                                      Provenance::kInterpolated,
                                      Provenance::kRegionPlane}) {
    EXPECT_LT(values[static_cast<size_t>(provenance)], measured);
  }
  EXPECT_FLOAT_EQ(
      Confidences(0.9f, *device_)[static_cast<size_t>(Provenance::kMeasured)],
      0.9f);
}

TEST_F(ComposeTest, DoubtfulDepthsAreDropped) {
  constexpr float kValues[] = {0.f, 0.2f, 0.29f, 0.3f, 0.9f};
  constexpr int kCount = 5;
  const Image<float> depth(kCount, 1, 5.f);
  const Image<Vec3f> normal(kCount, 1, kOwnNormal);
  const Image<uint8_t> provenance(
      kCount, 1, static_cast<uint8_t>(Provenance::kMeasured));
  Image<float> values(kCount, 1);
  std::copy(std::begin(kValues), std::end(kValues), values.begin());
  for (const float limit : {0.f, 0.3f, 1.f}) {
    SCOPED_TRACE(limit);
    ComposedMap map;
    map.map.depth = DeviceImage<float>(*device_, depth);
    map.map.normal = DeviceImage<Vec3f>(*device_, normal);
    map.provenance = DeviceImage<uint8_t>(*device_, provenance);
    const DeviceImage<float> confidence(*device_, values);
    const Image<uint8_t> levels =
        FinishMap(limit, {1, 1, 0, 0}, confidence.View(), &map, *device_)
            .ToHost();
    for (int x = 0; x < kCount; ++x) {
      const bool stays = kValues[x] > 0.f && kValues[x] >= limit;
      EXPECT_EQ(map.map.depth.ToHost()(x, 0), stays ? 5.f : 0.f);
      EXPECT_EQ(map.map.normal.ToHost()(x, 0), stays ? kOwnNormal : Vec3f{});
      EXPECT_EQ(map.provenance.ToHost()(x, 0), stays ? provenance(x, 0) : 0);
      EXPECT_EQ(levels(x, 0), stays ? ToConfidenceLevel(kValues[x]) : 0);
    }
  }
}

TEST_F(ComposeTest, NormalsThatFaceAwayAreTiltedAndNoOthers) {
  const Intrinsics intrinsics{2.f, 2.f, 1.f, 0.f};
  // The rays are (-0.5, 0, 1), (0, 0, 1), (0.5, 0, 1) and (1, 0, 1).
  Image<Vec3f> normal(4, 1);
  normal(1, 0) = {0.6f, 0.f, -0.8f};
  normal(2, 0) = normal(3, 0) = Normalized(Vec3f{1.f, 0.2f, -0.49f});
  Image<float> confidence(4, 1, 0.5f);
  confidence(3, 0) = 0.f;
  ComposedMap map;
  map.map.depth = DeviceImage<float>(*device_, Image<float>(4, 1, 4.f));
  map.map.normal = DeviceImage<Vec3f>(*device_, normal);
  map.provenance = DeviceImage<uint8_t>(*device_, Image<uint8_t>(4, 1));
  const DeviceImage<float> on_device(*device_, confidence);
  const DeviceImage<uint8_t> levels =
      FinishMap(0.f, intrinsics, on_device.View(), &map, *device_);
  const Image<Vec3f> finished = map.map.normal.ToHost();
  EXPECT_EQ(finished(0, 0), normal(0, 0));
  EXPECT_EQ(finished(1, 0), normal(1, 0));
  const Vec3f& tilted = finished(2, 0);
  EXPECT_LT(Dot(tilted, intrinsics.Ray(2.f, 0.f)), 0.f);
  EXPECT_NEAR(Norm(tilted), 1.f, 1e-6f);
  // Tilted by less than a degree.
  EXPECT_GT(Dot(tilted, normal(2, 0)), 0.9998f);
  EXPECT_EQ(levels.ToHost()(2, 0), 128);
  EXPECT_EQ(finished(3, 0), Vec3f());
}

TEST(ConfidenceLevel, IsZeroForNoDepthAlone) {
  EXPECT_EQ(ToConfidenceLevel(0.f), 0);
  EXPECT_EQ(ToConfidenceLevel(1e-6f), 1);
  EXPECT_EQ(ToConfidenceLevel(0.01f), 3);
  EXPECT_EQ(ToConfidenceLevel(1.f), 255);
  EXPECT_EQ(ToConfidenceLevel(1.1f), 255);
}

TEST(ConfidenceLevel, IsTheNearest) {
  for (int level = 1; level <= 255; ++level) {
    const auto bits = static_cast<uint8_t>(level);
    const float confidence = ConfidenceOfLevel(bits);
    EXPECT_EQ(ToConfidenceLevel(confidence), level);
    EXPECT_EQ(ToConfidenceLevel(confidence - 0.45f / 255.f), level);
    EXPECT_EQ(ToConfidenceLevel(confidence + 0.45f / 255.f), level);
  }
}

}  // namespace
}  // namespace tsar
