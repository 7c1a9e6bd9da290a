// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/depth_sigma.h"

#include "colmap_tsar/base/arithmetic.h"

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kScene = 5.f;
constexpr float kOff = 4.f;
constexpr float kNoise = 0.5f;
// All constants are different.
constexpr SceneSigmaOptions kOptions = {.moved = 1.f,
                                        .filled_measured = 2.f,
                                        .filled_carried = 3.f,
                                        .filled_guessed = 4.f,
                                        .standing = 5.f,
                                        .interpolated = 6.f,
                                        .on_cylinder = 7.f};

// Pixels in a row, each a superpixel of its own, on a plane that faces the
// camera. One pixel of disparity is 1 % of the depth.
class DepthSigmaTest : public testing::Test {
 protected:
  DepthSigmaTest() {
    resolution_.error_per_depth = 0.01f / kScene;
    of_superpixel_.resize(kWidth);
  }

  void Set(int x,
           float depth,
           Provenance provenance,
           LabelOrigin origin = LabelOrigin::kMeasured) {
    depth_(x, 0) = depth;
    provenance_(x, 0) = static_cast<uint8_t>(provenance);
    of_superpixel_[x].origin = origin;
  }
  // As fractions of the depth.
  std::vector<float> Compute(bool is_of_scene = true) {
    Image<uint16_t> superpixels(kWidth, 1);
    for (int x = 0; x < kWidth; ++x) {
      superpixels(x, 0) = static_cast<uint16_t>(x);
    }
    const Image<Plane> planes(kWidth, 1, Plane{{0.f, 0.f, -1.f}, kScene});
    const Image<uint8_t> flags(kWidth, 1);
    const ComposeSceneInputs inputs{
        on_device_(flags),
        {on_device_(planes), Intrinsics{10.f, 10.f, 0.f, 0.f}, kWidth, 1},
        on_device_(superpixels),
        on_device_(of_superpixel_),
        {},
        {on_device_(prior_depth_),
         on_device_(prior_sigma_),
         0.1f,
         Intrinsics{10.f, 10.f, 0.f, 0.f},
         kWidth,
         1}};
    ComposedMap composed;
    composed.map.depth = DeviceImage<float>(*device_, depth_);
    composed.provenance = DeviceImage<uint8_t>(*device_, provenance_);
    const Image<uint16_t> halves =
        is_of_scene ? ComputeSceneSigma(composed,
                                        inputs,
                                        resolution_,
                                        on_device_(variances_),
                                        kNoise,
                                        kOptions,
                                        *device_)
                          .ToHost()
                    : ComputeSigma(composed,
                                   resolution_,
                                   {.measured = 1.f,
                                    .superpixel_plane = 2.f,
                                    .region_plane = 3.f,
                                    .interpolated = 4.f},
                                   *device_)
                          .ToHost();
    std::vector<float> shares;
    for (int x = 0; x < kWidth; ++x) {
      const float sigma = HalfToFloat(halves(x, 0));
      shares.push_back(depth_(x, 0) > 0.f ? sigma / depth_(x, 0) : sigma);
    }
    return shares;
  }

  static constexpr int kWidth = 10;
  const std::unique_ptr<Device> device_ = CreateTestDevice(2);
  DeviceCopies on_device_{*device_};
  DepthResolution resolution_;
  Image<float> depth_{kWidth, 1};
  Image<uint8_t> provenance_{kWidth, 1};
  std::vector<ComposedSuperpixel> of_superpixel_;
  Image<float> prior_depth_;  // None.
  Image<float> prior_sigma_;
  Image<float> variances_{kWidth, 1};  // On cylinders.
};

TEST_F(DepthSigmaTest, TellsKindsOfDepthsApart) {
  Set(1, kScene, Provenance::kMeasured);
  Set(2, kScene, Provenance::kRegionPlane);
  Set(3, kScene, Provenance::kOtherViews, LabelOrigin::kCarried);
  Set(4, kScene, Provenance::kGuessed, LabelOrigin::kGuessed);
  Set(5, kOff, Provenance::kMeasured);
  Set(6, kOff, Provenance::kInterpolated);
  const std::vector<float> sigma = Compute();
  const float unit = 0.01f;
  const float unit_off = 0.01f * kOff / kScene;
  const std::vector<float> expected = {0.f,
                                       1.f * unit,
                                       2.f * unit,
                                       3.f * unit,
                                       4.f * unit,
                                       5.f * kNoise * unit_off,
                                       6.f * unit_off};
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(sigma[i], expected[i], 1e-3f * expected[i]) << i;
  }
}

TEST_F(DepthSigmaTest, AddsTheErrorOfThePlane) {
  for (const int x : {0, 5}) {
    Set(x, kScene, Provenance::kMeasured);
    // Of 1/z: 0.006 on the axis, more off it.
    of_superpixel_[x].error.zz = 0.006f * 0.006f;
    of_superpixel_[x].error.xx = 0.01f * 0.01f;
  }
  const std::vector<float> sigma = Compute();
  EXPECT_NEAR(sigma[0], std::hypot(0.006f * kScene, 0.01f), 1e-4f);
  EXPECT_NEAR(sigma[5],
              std::hypot(0.006f * kScene, 0.5f * 0.01f * kScene, 0.01f),
              1e-4f);
}

TEST_F(DepthSigmaTest, OnACylinderAddsItsError) {
  Set(1, kScene, Provenance::kInterpolated);
  variances_(0, 0) = variances_(1, 0) = 0.3f * 0.3f;
  const std::vector<float> sigma = Compute();
  EXPECT_EQ(sigma[0], 0.f);
  EXPECT_NEAR(sigma[1] * kScene, std::hypot(0.3f, 0.07f * kScene), 1e-3f);
}

TEST_F(DepthSigmaTest, OfAPriorItIsThePriorsOwn) {
  prior_depth_ = Image<float>(kWidth, 1, kOff);
  prior_sigma_ = Image<float>(kWidth, 1, 0.03f);
  prior_sigma_(2, 0) = 0.12f;
  Set(1, kOff, Provenance::kPrior);
  Set(2, kOff, Provenance::kPrior);
  Set(3, kScene, Provenance::kMeasured);
  of_superpixel_[1].error.zz = 0.006f * 0.006f;
  const std::vector<float> sigma = Compute();
  EXPECT_NEAR(sigma[1], 0.03f, 1e-4f);
  EXPECT_NEAR(sigma[2], 0.12f, 1e-4f);
  EXPECT_NEAR(sigma[3], 0.01f, 1e-4f);
}

TEST_F(DepthSigmaTest, IsNeverZeroWhereThereIsADepth) {
  resolution_.error_per_depth = 0.f;
  Set(1, 1e-6f, Provenance::kMeasured);
  Set(2, 1e6f, Provenance::kInterpolated);
  for (const bool is_of_scene : {true, false}) {
    const std::vector<float> sigma = Compute(is_of_scene);
    EXPECT_EQ(sigma[0], 0.f);
    EXPECT_GT(sigma[1], 0.f);
    EXPECT_GT(sigma[2], 0.f);
  }
}

TEST_F(DepthSigmaTest, GoesByProvenanceInAViewAlone) {
  Set(1, kScene, Provenance::kMeasured);
  Set(2, kScene, Provenance::kSuperpixelPlane);
  Set(3, kScene, Provenance::kRegionPlane);
  Set(4, kScene, Provenance::kInterpolated);
  const std::vector<float> sigma = Compute(false);
  for (int x = 0; x <= 4; ++x) {
    EXPECT_NEAR(sigma[x], 0.01f * x, 1e-5f);
  }
}

}  // namespace
}  // namespace tsar
