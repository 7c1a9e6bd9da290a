// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/compose_scene.h"

#include "colmap_tsar/filtering/confirmation.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/scene_planes/measurement_rating.h"

#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 6;
constexpr Vec3f kOwnNormal{0.f, 0.6f, -0.8f};
constexpr Vec3f kPlaneNormal{0.f, 0.f, -1.f};
constexpr float kScene = 5.f;
constexpr float kRegion = 7.f;

// Off all planes by far.
constexpr float kOff = 4.f;
// Of every superpixel.
constexpr SurfaceConfidence kConfidence = {.moved = 0.9f, .filled = 0.6f};

struct Result {
  Image<float> depth;
  Image<Vec3f> normal;
  Image<uint8_t> provenance;
  Image<float> confidence;
};

// Starts with a raster of the size of the map, planes that face the camera, and
// nothing measured. On a plane is what is less than 1 % off. No other view.
class ComposeSceneTest : public testing::Test {
 protected:
  ComposeSceneTest() {
    options_.on_plane = 5.f;
    scale_.error_per_depth =
        0.f;  // A pixel of disparity is 0.2 % of the depth.
    evidence_.width = kWidth;
    evidence_.height = kHeight;
    views_ = {{&evidence_, {}}};
    std::iota(superpixels_.begin(), superpixels_.end(), uint16_t{0});
  }

  static Plane PlaneAt(float depth) { return {kPlaneNormal, depth}; }
  static Image<Plane> PlanesAt(float depth) {
    return Image<Plane>(kWidth, kHeight, PlaneAt(depth));
  }
  void SetAllEvidence(LabelEvidence evidence) {
    of_superpixel_.assign(of_superpixel_.size(), {evidence, kConfidence});
  }

  void Measure(int x, int y, float depth) {
    own_(x, y) = depth;
    ratings_(x, y) = MeasurementRating::Pack(true, Confirmation::kNone);
  }
  void MeasureWithoutTrust(int x,
                           int y,
                           float depth,
                           Confirmation confirmation = Confirmation::kNone) {
    own_(x, y) = depth;
    ratings_(x, y) = MeasurementRating::Pack(false, confirmation);
  }

  ComposeSceneInputs Inputs() const {
    const auto on_map = [&](const Image<Plane>& planes) {
      return PlaneRaster{planes.View(),
                         Intrinsics{10.f, 10.f, 0.f, 0.f},
                         own_.Width(),
                         own_.Height()};
    };
    return {ratings_.View(),
            on_map(scene_),
            superpixels_.View(),
            of_superpixel_.data(),
            on_map(region_),
            texture_.View()};
  }
  ComposedMap ComposeOnDevice(DeviceImage<float>* own_confidence) const {
    Image<Vec3f> normal(own_.Width(), own_.Height());
    for (size_t i = 0; i < own_.NumPixels(); ++i) {
      normal.Data()[i] = own_.Data()[i] > 0.f ? kOwnNormal : Vec3f{};
    }
    DepthNormalImages own;
    own.depth = DeviceImage<float>(*device_, own_);
    own.normal = DeviceImage<Vec3f>(*device_, normal);
    return ComposeScene(std::move(own),
                        Inputs(),
                        {views_, {}},
                        scale_,
                        options_,
                        own_confidence,
                        *device_);
  }
  Result Compose() const {
    DeviceImage<float> own_confidence;
    const ComposedMap composed = ComposeOnDevice(&own_confidence);
    return {
        composed.map.depth.ToHost(),
        composed.map.normal.ToHost(),
        composed.provenance.ToHost(),
        RateSceneConfidence(
            composed, Inputs(), std::as_const(own_confidence).View(), *device_)
            .ToHost()};
  }

  static void Expect(const Result& result,
                     int x,
                     int y,
                     float depth,
                     const Vec3f& normal,
                     Provenance provenance,
                     float confidence) {
    SCOPED_TRACE(std::to_string(x) + ", " + std::to_string(y));
    EXPECT_FLOAT_EQ(result.depth(x, y), depth);
    EXPECT_EQ(result.normal(x, y), normal);
    EXPECT_EQ(result.provenance(x, y), static_cast<uint8_t>(provenance));
    EXPECT_FLOAT_EQ(result.confidence(x, y), confidence);
  }
  // Its confidence is its own.
  static void ExpectMeasured(const Result& result, int x, int y, float depth) {
    Expect(result,
           x,
           y,
           depth,
           kOwnNormal,
           Provenance::kMeasured,
           result.confidence(x, y));
    EXPECT_GT(result.confidence(x, y), 0.f);
    EXPECT_LT(result.confidence(x, y), 1.f);
  }

  const std::unique_ptr<Device> device_ = Device::CreateCpu(2);
  ComposeSceneOptions options_;
  DisparityScale scale_;
  Image<float> own_{kWidth, kHeight};
  Image<uint8_t> ratings_{kWidth, kHeight};
  Image<Plane> scene_{kWidth, kHeight};
  // Each pixel is one.
  Image<uint16_t> superpixels_{kWidth, kHeight};
  std::vector<ComposedSuperpixel> of_superpixel_{
      kWidth * kHeight, {LabelEvidence::kNone, kConfidence}};
  Image<Plane> region_{kWidth, kHeight};
  Image<float> texture_{kWidth, kHeight, 10.f};
  ViewEvidence evidence_;
  std::vector<ObservedView> views_;
};

TEST_F(ComposeSceneTest, NothingIsMadeOfNothing) {
  // Depths that are not trusted do not count.
  MeasureWithoutTrust(3, 3, 4.f);
  const Result result = Compose();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Expect(result, x, y, 0.f, {}, Provenance::kNone, 0.f);
    }
  }
}

TEST_F(ComposeSceneTest, APlaneOfTheSceneGoesWhereItIsLabelled) {
  region_ = PlanesAt(kRegion);
  for (int x = 0; x < 4; ++x) {
    scene_(x, 0) = PlaneAt(kScene);
    of_superpixel_[static_cast<size_t>(x)] = {
        static_cast<LabelEvidence>(x),
        {.moved = 0.1f * x, .filled = 0.11f * x}};
  }
  // As good as on the plane, and not trusted.
  Measure(3, 0, 5.03f);
  MeasureWithoutTrust(1, 0, 5.03f);
  const Result result = Compose();
  Expect(result, 1, 0, kScene, kPlaneNormal, Provenance::kGuessed, 0.11f);
  Expect(result, 2, 0, kScene, kPlaneNormal, Provenance::kOtherViews, 0.22f);
  Expect(result, 3, 0, kScene, kPlaneNormal, Provenance::kMeasured, 0.3f);
  Expect(result,
         4,
         0,
         kRegion,
         kPlaneNormal,
         Provenance::kRegionPlane,
         kConfidenceOfRegion);
  ASSERT_EQ(static_cast<int>(LabelEvidence::kGuessed), 1);
  ASSERT_EQ(static_cast<int>(LabelEvidence::kCarried), 2);
}

TEST_F(ComposeSceneTest, WhatTheViewSeesItselfIsAPlaneOfARegion) {
  scene_ = PlanesAt(kScene);
  SetAllEvidence(LabelEvidence::kMeasured);
  Expect(Compose(),
         5,
         3,
         kScene,
         kPlaneNormal,
         Provenance::kRegionPlane,
         kConfidence.filled);
}

// What the views say decides between two surfaces: see ViewVotesTest for how
// they are asked, MeasurementSupportTest for how their answers are weighed.
TEST_F(ComposeSceneTest, ADepthOffItsPlaneStandsOrGivesWayByItsLogOdds) {
  scene_ = PlanesAt(kScene);
  SetAllEvidence(LabelEvidence::kCarried);
  Measure(2, 2, kOff);
  MeasureWithoutTrust(4, 2, kOff, Confirmation::kWeak);
  MeasureWithoutTrust(6, 2, kOff);
  options_.min_log_odds = -100.f;
  Result result = Compose();
  ExpectMeasured(result, 2, 2, kOff);
  ExpectMeasured(result, 4, 2, kOff);
  EXPECT_FLOAT_EQ(result.depth(6, 2), kScene);
  EXPECT_GT(result.confidence(2, 2), result.confidence(4, 2));
  options_.min_log_odds = 100.f;
  result = Compose();
  for (const int x : {2, 4, 6}) {
    Expect(result,
           x,
           2,
           kScene,
           kPlaneNormal,
           Provenance::kOtherViews,
           kConfidence.filled);
  }
}

// As if it had been measured on the plane, which it was but for noise.
TEST_F(ComposeSceneTest, ADepthThatGivesWayToAPlaneNearbyMovesOntoIt) {
  options_.on_plane = 0.5f;
  options_.min_log_odds = 100.f;
  scene_ = PlanesAt(kScene);
  Measure(2, 2, kScene / 1.002f);
  Measure(4, 2, kScene / 1.004f);
  const Result result = Compose();
  Expect(result,
         2,
         2,
         kScene,
         kPlaneNormal,
         Provenance::kMeasured,
         kConfidence.moved);
  EXPECT_EQ(result.provenance(4, 2),
            static_cast<uint8_t>(Provenance::kGuessed));
}

TEST_F(ComposeSceneTest, WhereThereIsNoPlaneMeasurementsStand) {
  region_ = PlanesAt(kRegion);
  options_.min_log_odds = 100.f;
  Measure(2, 2, kOff);
  MeasureWithoutTrust(4, 2, kOff, Confirmation::kDistinct);
  MeasureWithoutTrust(6, 2, kOff);
  const Result result = Compose();
  ExpectMeasured(result, 2, 2, kOff);
  ExpectMeasured(result, 4, 2, kOff);
  EXPECT_FLOAT_EQ(result.depth(6, 2), kRegion);
}

TEST_F(ComposeSceneTest, RegionsCountOnlyWhereTheSceneHasNoPlane) {
  region_ = PlanesAt(kRegion);
  scene_(0, 0) = PlaneAt(kScene);
  Measure(4, 4, kOff);
  const Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(0, 0), kScene);
  ExpectMeasured(result, 4, 4, kOff);
  Expect(result,
         1,
         0,
         kRegion,
         kPlaneNormal,
         Provenance::kRegionPlane,
         kConfidenceOfRegion);
}

TEST_F(ComposeSceneTest, TheToleranceGrowsWithTheErrorOfADepth) {
  options_ = {};
  options_.min_log_odds = -100.f;
  scale_.error_per_depth = 0.002f;  // 1 % at a depth of 5.
  scene_ = PlanesAt(kScene);
  const auto limit = options_.on_plane * 0.01f;
  Measure(2, 2, kScene * (1.f + 0.9f * limit));
  Measure(6, 2, kScene * (1.f + 1.2f * limit));
  const Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(2, 2), kScene);
  EXPECT_FLOAT_EQ(result.depth(6, 2), own_(6, 2));
}

TEST_F(ComposeSceneTest, InterpolatedDepthsHaveAConfidenceOfTheirOwn) {
  Image<uint8_t> filled(kWidth, kHeight);
  filled(1, 1) = 1;
  DeviceImage<float> own_confidence;
  ComposedMap composed = ComposeOnDevice(&own_confidence);
  MarkInterpolated(std::as_const(filled).View(), &composed, *device_);
  const Image<float> confidence =
      RateSceneConfidence(
          composed, Inputs(), std::as_const(own_confidence).View(), *device_)
          .ToHost();
  EXPECT_FLOAT_EQ(confidence(1, 1), kConfidenceOfInterpolated);
  EXPECT_EQ(confidence(0, 0), 0.f);
}

}  // namespace
}  // namespace tsar
