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
constexpr SurfaceConfidence kConfidence = {
    .moved = 0.9f, .filled = 0.6f, .standing = 0.7f, .standing_weakly = 0.2f};

struct Result {
  Image<float> depth;
  Image<Vec3f> normal;
  Image<uint8_t> provenance;
  Image<float> confidence;
};

// Starts with a raster of the size of the map, planes that face the camera, and
// nothing measured. On a plane is what is less than 1 % off.
class ComposeSceneTest : public testing::Test {
 protected:
  ComposeSceneTest() {
    options_.on_plane = {0.01f, 0.f};
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
            on_map(region_)};
  }
  ComposedMap ComposeOnDevice() const {
    Image<Vec3f> normal(own_.Width(), own_.Height());
    for (size_t i = 0; i < own_.NumPixels(); ++i) {
      normal.Data()[i] = own_.Data()[i] > 0.f ? kOwnNormal : Vec3f{};
    }
    DepthNormalImages own;
    own.depth = DeviceImage<float>(*device_, own_);
    own.normal = DeviceImage<Vec3f>(*device_, normal);
    return ComposeScene(std::move(own), Inputs(), scale_, options_, *device_);
  }
  Result Compose() const {
    const ComposedMap composed = ComposeOnDevice();
    return {composed.map.depth.ToHost(),
            composed.map.normal.ToHost(),
            composed.provenance.ToHost(),
            RateSceneConfidence(composed, Inputs(), *device_).ToHost()};
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
  static void ExpectMeasured(const Result& result,
                             int x,
                             int y,
                             float depth,
                             float confidence = kConfidence.standing) {
    Expect(result, x, y, depth, kOwnNormal, Provenance::kMeasured, confidence);
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

TEST_F(ComposeSceneTest, BlobsOffThePlaneStayAndSpecksYield) {
  options_.min_blob = 5;
  scene_ = PlanesAt(kScene);
  SetAllEvidence(LabelEvidence::kCarried);
  for (int x = 0; x < 5; ++x) {
    Measure(x, 0, kOff);
    if (x < 4) {
      Measure(x, 2, kOff);
    } else {
      MeasureWithoutTrust(x, 2, kOff);
    }
    // On a diagonal, hence not side by side.
    Measure(7 + x, 1 + x, kOff);
  }
  const Result result = Compose();
  for (int x = 0; x < 5; ++x) {
    ExpectMeasured(result, x, 0, kOff);
    for (const auto& [speck_x, speck_y] : {std::pair(x, 2), {7 + x, 1 + x}}) {
      Expect(result,
             speck_x,
             speck_y,
             kScene,
             kPlaneNormal,
             Provenance::kOtherViews,
             kConfidence.filled);
    }
  }
}

TEST_F(ComposeSceneTest, AConfirmedDepthStandsAlone) {
  options_.min_blob = 5;
  scene_ = PlanesAt(kScene);
  scene_(8, 4) = {};
  region_ = PlanesAt(kRegion);
  MeasureWithoutTrust(2, 2, kOff, Confirmation::kWeak);
  MeasureWithoutTrust(8, 4, kOff, Confirmation::kDistinct);
  MeasureWithoutTrust(5, 2, kOff);
  Measure(10, 1, kOff);
  Result result = Compose();
  ExpectMeasured(result, 2, 2, kOff, kConfidence.standing_weakly);
  ExpectMeasured(result, 8, 4, kOff);
  EXPECT_FLOAT_EQ(result.depth(5, 2), kScene);
  EXPECT_FLOAT_EQ(result.depth(10, 1), kScene);
  options_.keep_confirmed = false;
  result = Compose();
  EXPECT_FLOAT_EQ(result.depth(2, 2), kScene);
  EXPECT_FLOAT_EQ(result.depth(8, 4), kRegion);
}

TEST_F(ComposeSceneTest, AConfirmedDepthMovesOntoItsPlaneWithinItsOwnSpread) {
  options_.on_plane_distinct = {0.004f, 0.f};
  scene_ = PlanesAt(kScene);
  MeasureWithoutTrust(2, 2, kScene * 1.003f, Confirmation::kDistinct);
  MeasureWithoutTrust(5, 2, kScene * 1.006f, Confirmation::kDistinct);
  Measure(8, 2, kScene * 1.006f);
  const Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(2, 2), kScene);
  ExpectMeasured(result, 5, 2, kScene * 1.006f);
  EXPECT_FLOAT_EQ(result.depth(8, 2), kScene);
}

TEST_F(ComposeSceneTest, WeakTextureHoldsADepthOffItsPlaneOnlyFromAfar) {
  scale_.error_per_depth = 0.f;  // A pixel of disparity is 0.2 % of the depth.
  options_.on_plane_weak.pixels = options_.on_plane_distinct.pixels = 0.5f;
  scene_ = PlanesAt(kScene);
  constexpr float kNear = kScene / 1.014f;
  constexpr float kFar = kScene / 1.016f;
  MeasureWithoutTrust(1, 2, kNear, Confirmation::kWeak);
  MeasureWithoutTrust(3, 2, kFar, Confirmation::kWeak);
  MeasureWithoutTrust(5, 2, kNear, Confirmation::kDistinct);
  // Trust does not change it.
  own_(7, 2) = kNear;
  ratings_(7, 2) = MeasurementRating::Pack(true, Confirmation::kWeak);
  Result result = Compose();
  Expect(result,
         1,
         2,
         kScene,
         kPlaneNormal,
         Provenance::kMeasured,
         kConfidence.moved);
  ExpectMeasured(result, 3, 2, kFar, kConfidence.standing_weakly);
  ExpectMeasured(result, 5, 2, kNear);
  EXPECT_FLOAT_EQ(result.depth(7, 2), kScene);
  // Depths may scatter more than that.
  options_.on_plane_weak.pixels = 10.f;
  result = Compose();
  EXPECT_FLOAT_EQ(result.depth(3, 2), kScene);
  ExpectMeasured(result, 5, 2, kNear);
}

TEST_F(ComposeSceneTest, ABlobIsMeasuredOnTheRaster) {
  options_.min_blob = 3;
  // Two pixels of the map, in each direction, for one of the raster.
  superpixels_ = Image<uint16_t>(kWidth / 2, kHeight / 2);
  for (int x = 0; x < kWidth; ++x) {
    Measure(x, 0, kOff);
    if (x < kWidth - 1) {
      Measure(x, 3, kOff);
    }
  }
  const Result result = Compose();
  for (int x = 0; x < kWidth; ++x) {
    ExpectMeasured(result, x, 0, kOff);
    Expect(result, x, 3, 0.f, {}, Provenance::kNone, 0.f);
  }
}

TEST_F(ComposeSceneTest, NothingStandsOffThePlaneWhereThatIsNotAllowed) {
  options_.keep_off_plane = false;
  SetAllEvidence(LabelEvidence::kMeasured);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Measure(x, y, kOff);
      if (x >= kWidth / 2) {
        scene_(x, y) = PlaneAt(kScene);
      }
    }
  }
  const Result result = Compose();
  Expect(result,
         kWidth / 2,
         2,
         kScene,
         kPlaneNormal,
         Provenance::kMeasured,
         kConfidence.moved);
  // Where there is no plane, none is off it.
  ExpectMeasured(result, kWidth / 2 - 1, 2, kOff);
}

TEST_F(ComposeSceneTest, RegionsCountOnlyWhereTheSceneHasNoPlane) {
  options_.min_blob = 2;
  region_ = PlanesAt(kRegion);
  scene_(0, 0) = PlaneAt(kScene);
  // Neither a blob with a plane to be off from, nor a speck.
  Measure(4, 4, kOff);
  Measure(5, 4, kOff);
  Measure(9, 0, kOff);
  const Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(0, 0), kScene);
  ExpectMeasured(result, 4, 4, kOff);
  for (const int x : {1, 9}) {
    Expect(result,
           x,
           0,
           kRegion,
           kPlaneNormal,
           Provenance::kRegionPlane,
           kConfidenceOfRegion);
  }
}

TEST_F(ComposeSceneTest, TheToleranceGrowsWithTheErrorOfADepth) {
  options_ = {};
  options_.min_blob = 1;
  scale_.error_per_depth = 0.002f;  // 1 % at a depth of 5.
  scene_ = PlanesAt(kScene);
  const auto limit = static_cast<float>(options_.on_plane.pixels) * 0.01f;
  Measure(2, 2, kScene * (1.f + 0.9f * limit));
  Measure(6, 2, kScene * (1.f + 1.2f * limit));
  const Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(2, 2), kScene);
  EXPECT_FLOAT_EQ(result.depth(6, 2), own_(6, 2));
}

TEST_F(ComposeSceneTest, InterpolatedDepthsHaveAConfidenceOfTheirOwn) {
  Image<uint8_t> filled(kWidth, kHeight);
  filled(1, 1) = 1;
  ComposedMap composed = ComposeOnDevice();
  MarkInterpolated(std::as_const(filled).View(), &composed, *device_);
  const Image<float> confidence =
      RateSceneConfidence(composed, Inputs(), *device_).ToHost();
  EXPECT_FLOAT_EQ(confidence(1, 1), kConfidenceOfInterpolated);
  EXPECT_EQ(confidence(0, 0), 0.f);
}

}  // namespace
}  // namespace tsar
