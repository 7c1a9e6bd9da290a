// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_scene.h"

#include "colmap_tsar/compose/depth_confidence.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/filter/confirmation.h"

#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 12;
constexpr int kHeight = 6;
constexpr Vec3f kOwnNormal{0.f, 0.6f, -0.8f};
constexpr Vec3f kPlaneNormal{0.f, 0.f, -1.f};
constexpr float kScene = 5.f;

// Far off all planes.
constexpr float kOff = 4.f;
// The measures of every superpixel.
constexpr LabelMeasures kLabel = {
    .strength = 0.5f, .confirmed = 0.2f, .uncertainty = 0.1f, .margin = 0.4f};

constexpr float kResolution = 0.002f;
constexpr float kNoise = 0.2f;

// The confidence of a depth on a plane that no other view sees.
float ConfidenceOnPlane(DepthKind kind, const LabelMeasures& label = kLabel) {
  return ConfidenceOf({kind, {}, label, kResolution, kNoise});
}

struct Result {
  Image<float> depth;
  Image<Vec3f> normal;
  Image<uint8_t> provenance;
  Image<float> confidence;
};

// Starts with a raster of the size of the map, planes that face the camera, no
// measurements and no other views. Depths within 1 % are on a plane.
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
  void SetAllOrigins(LabelOrigin origin) {
    of_superpixel_.assign(of_superpixel_.size(), {origin, kLabel});
  }

  void Measure(int x, int y, float depth) {
    own_(x, y) = depth;
    ratings_(x, y) = MeasurementFlags::Pack(true, Confirmation::kNone);
  }
  void MeasureWithoutTrust(int x,
                           int y,
                           float depth,
                           Confirmation confirmation = Confirmation::kNone) {
    own_(x, y) = depth;
    ratings_(x, y) = MeasurementFlags::Pack(false, confirmation);
  }

  ComposeSceneInputs Inputs() {
    const auto on_map = [&](const Image<Plane>& planes) {
      return PlaneRaster{on_device_(planes),
                         Intrinsics{10.f, 10.f, 0.f, 0.f},
                         own_.Width(),
                         own_.Height()};
    };
    return {on_device_(ratings_),
            on_map(scene_),
            on_device_(superpixels_),
            on_device_(of_superpixel_),
            on_device_(texture_),
            {on_device_(prior_depth_),
             on_device_(prior_sigma_),
             outlier_share_,
             Intrinsics{10.f, 10.f, 0.f, 0.f},
             own_.Width(),
             own_.Height()}};
  }
  // The same prior in every pixel.
  void SetPrior(float depth, float sigma) {
    prior_depth_ = Image<float>(kWidth, kHeight, depth);
    prior_sigma_ = Image<float>(kWidth, kHeight, sigma);
  }
  ComposedMap ComposeOnDevice() {
    Image<Vec3f> normal(own_.Width(), own_.Height());
    for (size_t i = 0; i < own_.NumPixels(); ++i) {
      normal.Data()[i] = own_.Data()[i] > 0.f ? kOwnNormal : Vec3f{};
    }
    DepthNormalImages own;
    own.depth = DeviceImage<float>(*device_, own_);
    own.normal = DeviceImage<Vec3f>(*device_, normal);
    return ComposeScene(
        std::move(own), Inputs(), {views_, {}}, scale_, options_, *device_);
  }
  Result Compose() {
    ComposedMap composed = ComposeOnDevice();
    DeviceImage<float> confidence = Rate(composed);
    FillByPrior(
        Inputs(), min_fill_confidence_, &composed, &confidence, *device_);
    return {composed.map.depth.ToHost(),
            composed.map.normal.ToHost(),
            composed.provenance.ToHost(),
            confidence.ToHost()};
  }
  DeviceImage<float> Rate(const ComposedMap& composed,
                          ImageView<const float> variances_on_cylinders = {}) {
    return ComputeSceneConfidence(composed,
                                  Inputs(),
                                  {views_, {}},
                                  scale_,
                                  variances_on_cylinders,
                                  kNoise,
                                  min_fill_confidence_,
                                  *device_);
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
  // It keeps the confidence of the measurement.
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

  const std::unique_ptr<Device> device_ = CreateTestDevice(2);
  DeviceCopies on_device_{*device_};
  ComposeSceneOptions options_;
  float min_fill_confidence_ = 0.f;
  DisparityScale scale_;
  Image<float> own_{kWidth, kHeight};
  Image<uint8_t> ratings_{kWidth, kHeight};
  Image<Plane> scene_{kWidth, kHeight};
  // Each pixel is a superpixel.
  Image<uint16_t> superpixels_{kWidth, kHeight};
  std::vector<ComposedSuperpixel> of_superpixel_{kWidth * kHeight,
                                                 {LabelOrigin::kNone, kLabel}};
  Image<float> texture_{kWidth, kHeight, 10.f};
  Image<float> prior_depth_;  // None.
  Image<float> prior_sigma_;
  float outlier_share_ = 0.05f;
  ViewEvidence evidence_;
  std::vector<ObservedView> views_;
};

TEST_F(ComposeSceneTest, APlaneOfTheSceneGoesWhereItIsLabeled) {
  for (int x = 0; x < 4; ++x) {
    scene_(x, 0) = PlaneAt(kScene);
    of_superpixel_[x] = {static_cast<LabelOrigin>(x), {.margin = 0.1f * x}};
  }
  // As good as on the plane, and not trusted.
  Measure(3, 0, 5.03f);
  MeasureWithoutTrust(1, 0, 5.03f);
  const Result result = Compose();
  const auto expect = [&](int x, Provenance provenance, DepthKind kind) {
    Expect(result,
           x,
           0,
           kScene,
           kPlaneNormal,
           provenance,
           ConfidenceOnPlane(kind, {.margin = 0.1f * x}));
  };
  expect(1, Provenance::kGuessed, DepthKind::kGuessed);
  expect(2, Provenance::kOtherViews, DepthKind::kCarried);
  expect(3, Provenance::kMeasured, DepthKind::kMoved);
  Expect(result, 4, 0, 0.f, {}, Provenance::kNone, 0.f);
  ASSERT_EQ(static_cast<int>(LabelOrigin::kGuessed), 1);
  ASSERT_EQ(static_cast<int>(LabelOrigin::kCarried), 2);
}

// The views decide between two surfaces: OcclusionVotesTest tests their votes,
// MeasurementSupportTest how these are weighted.
TEST_F(ComposeSceneTest, ADepthOffItsPlaneStandsOrGivesWayByItsLogOdds) {
  scene_ = PlanesAt(kScene);
  SetAllOrigins(LabelOrigin::kCarried);
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
           ConfidenceOnPlane(DepthKind::kCarried));
  }
}

// Like a measurement on the plane, from which only noise separates it.
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
         ConfidenceOnPlane(DepthKind::kMoved));
  EXPECT_EQ(result.provenance(4, 2),
            static_cast<uint8_t>(Provenance::kGuessed));
}

TEST_F(ComposeSceneTest, WhereThereIsNoPlaneMeasurementsStand) {
  options_.min_log_odds = 100.f;
  Measure(2, 2, kOff);
  MeasureWithoutTrust(4, 2, kOff, Confirmation::kDistinct);
  MeasureWithoutTrust(6, 2, kOff);
  const Result result = Compose();
  ExpectMeasured(result, 2, 2, kOff);
  ExpectMeasured(result, 4, 2, kOff);
  EXPECT_EQ(result.depth(6, 2), 0.f);
}

TEST_F(ComposeSceneTest, InterpolatedDepthsAndCylindersHaveTheirConfidences) {
  scene_(1, 1) = scene_(2, 1) = PlaneAt(kScene);
  ComposedMap composed = ComposeOnDevice();
  Image<uint8_t> provenance = composed.provenance.ToHost();
  provenance(1, 1) = static_cast<uint8_t>(Provenance::kInterpolated);
  composed.provenance = DeviceImage<uint8_t>(*device_, provenance);
  Image<float> variances(kWidth, kHeight);
  variances(2, 1) = 1e-30f;
  const Image<float> confidence =
      Rate(composed, on_device_(variances)).ToHost();
  EXPECT_FLOAT_EQ(confidence(1, 1),
                  ConfidenceOnPlane(DepthKind::kInterpolated));
  EXPECT_EQ(confidence(2, 1), 0.9f);
  EXPECT_EQ(confidence(0, 0), 0.f);
}

TEST_F(ComposeSceneTest, WhatWasNotMeasuredMustBeLikely) {
  scene_ = PlanesAt(kScene);
  SetAllOrigins(LabelOrigin::kGuessed);
  Measure(2, 2, kScene);
  Measure(4, 2, kOff);
  options_.min_log_odds = -100.f;
  const float likely = ConfidenceInSurface(
      {DepthKind::kGuessed, {}, kLabel, kResolution, kNoise});
  min_fill_confidence_ = likely - 0.01f;
  EXPECT_GT(Compose().confidence(0, 0), 0.f);
  min_fill_confidence_ = likely + 0.01f;
  const Result result = Compose();
  EXPECT_EQ(result.confidence(0, 0), 0.f);
  EXPECT_GT(result.confidence(2, 2), 0.f);
  EXPECT_GT(result.confidence(4, 2), 0.f);
}

TEST_F(ComposeSceneTest, APriorFillsWhereThereIsNoPlane) {
  scene_(1, 2) = PlaneAt(kScene);
  SetAllOrigins(LabelOrigin::kMeasured);
  SetPrior(6.f, 0.005f);
  prior_depth_(10, 2) = 0.f;
  MeasureWithoutTrust(5, 2, kOff);
  const Result result = Compose();
  for (const int x : {2, 5, 8}) {
    EXPECT_FLOAT_EQ(result.depth(x, 2), 6.f);
    EXPECT_EQ(result.provenance(x, 2),
              static_cast<uint8_t>(Provenance::kPrior));
    EXPECT_LT(Norm(result.normal(x, 2) - kPlaneNormal), 1e-5f);
  }
  EXPECT_FLOAT_EQ(result.depth(1, 2), kScene);
  EXPECT_EQ(result.provenance(1, 2),
            static_cast<uint8_t>(Provenance::kRegionPlane));
  Expect(result, 10, 2, 0.f, {}, Provenance::kNone, 0.f);
}

TEST_F(ComposeSceneTest, ConfidenceOfAPriorIsThatOfItsSigma) {
  min_fill_confidence_ = 0.3f;
  // One percent is two standard deviations, one, and a third of one.
  SetPrior(6.f, 0.005f);
  EXPECT_NEAR(Compose().confidence(3, 3), 0.95f * 0.954f, 0.01f);
  SetPrior(6.f, 0.01f);
  EXPECT_NEAR(Compose().confidence(3, 3), 0.95f * 0.683f, 0.01f);
  SetPrior(6.f, 0.03f);
  EXPECT_NEAR(Compose().confidence(3, 3), 0.95f * 0.261f, 0.01f);
  // Less than a third of its depths are within three percent: not used.
  SetPrior(6.f, 0.1f);
  EXPECT_EQ(Compose().confidence(3, 3), 0.f);
  outlier_share_ = 0.5f;
  SetPrior(6.f, 0.01f);
  EXPECT_NEAR(Compose().confidence(3, 3), 0.5f * 0.683f, 0.01f);
}

TEST_F(ComposeSceneTest, WithoutAPlaneAMeasurementGivesWayToACertainPrior) {
  outlier_share_ = 0.02f;
  MeasureWithoutTrust(2, 2, kOff, Confirmation::kWeak);
  MeasureWithoutTrust(4, 2, 6.02f, Confirmation::kWeak);
  texture_ = Image<float>(kWidth, kHeight, 0.5f);
  ExpectMeasured(Compose(), 2, 2, kOff);
  SetPrior(6.f, 0.005f);
  Result result = Compose();
  EXPECT_FLOAT_EQ(result.depth(2, 2), 6.f);
  EXPECT_EQ(result.provenance(2, 2), static_cast<uint8_t>(Provenance::kPrior));
  ExpectMeasured(result, 4, 2, 6.02f);
  // With a prior that agrees, the odds do not matter.
  options_.min_log_odds = 100.f;
  ExpectMeasured(Compose(), 4, 2, 6.02f);
  // A prior that is wrong half of the time is weaker evidence against others.
  options_.min_log_odds = -2.f;
  texture_(2, 2) = 10.f;
  Measure(2, 2, kOff);
  EXPECT_FLOAT_EQ(Compose().depth(2, 2), 6.f);
  outlier_share_ = 0.5f;
  ExpectMeasured(Compose(), 2, 2, kOff);
}

TEST_F(ComposeSceneTest, APriorSpeaksForAMeasurementOrForThePlane) {
  scene_ = PlanesAt(kScene);
  SetAllOrigins(LabelOrigin::kMeasured);
  Measure(2, 2, kOff);
  const float log_odds = LogOddsAgainst(
      {{}, GapInPixels(kOff, kScene, scale_), kLabel.margin}, {{}, 10.f, true});
  const auto depth_with = [&](float min_log_odds) {
    options_.min_log_odds = min_log_odds;
    return Compose().depth(2, 2);
  };
  EXPECT_EQ(depth_with(log_odds - 0.1f), kOff);
  EXPECT_FLOAT_EQ(depth_with(log_odds + 0.1f), kScene);
  // The logarithms of 0.05 and of 0.05 + 0.95 times 79.8, without their signs.
  constexpr float kMost = 4.33f + 3.f;
  SetPrior(kOff, 0.005f);
  EXPECT_EQ(depth_with(log_odds + kMost - 0.1f), kOff);
  EXPECT_FLOAT_EQ(depth_with(log_odds + kMost + 0.1f), kScene);
  SetPrior(kScene, 0.005f);
  EXPECT_EQ(depth_with(log_odds - kMost - 0.1f), kOff);
  EXPECT_FLOAT_EQ(depth_with(log_odds - kMost + 0.1f), kScene);
  // A prior on a third surface is no evidence.
  SetPrior(10.f, 0.005f);
  EXPECT_EQ(depth_with(log_odds - 0.1f), kOff);
  EXPECT_FLOAT_EQ(depth_with(log_odds + 0.1f), kScene);
}

TEST(DepthConfidenceTest, ValuesAreProbabilities) {
  for (int kind = 0; kind < kNumDepthKinds; ++kind) {
    for (const float value : {0.f, 1.f}) {
      for (const OcclusionVotes& votes : {OcclusionVotes{},
                                          OcclusionVotes{20, 0, 0},
                                          OcclusionVotes{0, 20, 20}}) {
        const float confidence = ConfidenceOf({static_cast<DepthKind>(kind),
                                               {votes, 100.f * value, true},
                                               {value, value, value, value},
                                               kResolution * value,
                                               10.f * value});
        EXPECT_GE(confidence, kMinConfidence);
        EXPECT_LE(confidence, 1.f - kMinConfidence);
      }
    }
  }
}

TEST(DepthConfidenceTest, ViewsThatAgreeRaiseItForEveryKind) {
  for (int kind = 0; kind < kNumDepthKinds; ++kind) {
    const auto with = [&](const OcclusionVotes& votes) {
      return ConfidenceOf({static_cast<DepthKind>(kind),
                           {votes, 5.f, false},
                           kLabel,
                           kResolution,
                           kNoise});
    };
    EXPECT_GT(with({4, 0, 0}), with({}));
    EXPECT_GT(with({4, 0, 0}), with({4, 0, 4}));
  }
}

TEST(DepthConfidenceTest, GrowsWithTheMarginAndFallsWithTheUncertainty) {
  for (const DepthKind kind : {DepthKind::kMoved,
                               DepthKind::kFilled,
                               DepthKind::kCarried,
                               DepthKind::kGuessed}) {
    LabelMeasures better = kLabel;
    better.margin += 0.2f;
    EXPECT_GT(ConfidenceOnPlane(kind, better), ConfidenceOnPlane(kind));
    LabelMeasures worse = kLabel;
    worse.uncertainty += 0.5f;
    EXPECT_LT(ConfidenceOnPlane(kind, worse), ConfidenceOnPlane(kind));
  }
}

}  // namespace
}  // namespace tsar
