// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/apply_cylinders.h"

#include "colmap_tsar/scene/evidence/measurement_flags.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr Intrinsics kIntrinsics = {40.f, 40.f, 20.f, 15.f};
constexpr float kWall = 4.f;
// A column of pixels in front of the cylinder's axis.
constexpr int kBefore = 20;

// Upright in front of the camera, below its optical axis.
CameraCylinder MakeCylinder(float distance, float radius) {
  CameraCylinder cylinder;
  cylinder.point = {0.f, 0.f, distance};
  cylinder.axis = {0.f, 1.f, 0.f};
  cylinder.radius = radius;
  cylinder.length = 1.f;
  cylinder.across = {1.f, 0.f, 0.f};
  cylinder.third = {0.f, 0.f, 1.f};
  return cylinder;
}

class ApplyCylindersTest : public testing::Test {
 protected:
  ApplyCylindersTest() {
    // One pixel of disparity is 1 % of a depth of 2.
    resolution_.error_per_depth = 0.005f;
  }

  void Lay(const std::vector<CameraCylinder>& cylinders) {
    composed_.map.depth = DeviceImage<float>(*device_, depth_);
    composed_.map.normal = DeviceImage<Vec3f>(
        *device_, Image<Vec3f>(kWidth, kHeight, {0.f, 0.f, -1.f}));
    composed_.provenance = DeviceImage<uint8_t>(*device_, provenance_);
    const DeviceImage<uint8_t> flags(*device_, ratings_);
    variances_ = ApplyCylinders(cylinders,
                                flags.View(),
                                kIntrinsics,
                                resolution_,
                                &composed_,
                                *device_);
    depth_ = composed_.map.depth.ToHost();
    normal_ = composed_.map.normal.ToHost();
    provenance_ = composed_.provenance.ToHost();
  }

  const std::unique_ptr<Device> device_ = CreateTestDevice();
  DepthResolution resolution_;
  Image<float> depth_{kWidth, kHeight, kWall};
  Image<Vec3f> normal_;
  Image<uint8_t> provenance_{
      kWidth, kHeight, static_cast<uint8_t>(Provenance::kMeasured)};
  Image<uint8_t> ratings_{kWidth, kHeight};
  ComposedMap composed_;
  DeviceImage<float> variances_;
};

TEST_F(ApplyCylindersTest, LaysWhatIsSeenAndLeavesTheRest) {
  Lay({MakeCylinder(2.5f, 0.5f)});
  int num_laid = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const float u = (x - 20) / 40.f;
    const float v = (y - 15) / 40.f;
    // (u z)² + (z - 2.5)² = 0.5²
    const float a = u * u + 1.f;
    const float discriminant = 6.25f - a * 6.f;
    const float z =
        discriminant > 0.f ? (2.5f - std::sqrt(discriminant)) / a : 0.f;
    if (z > 0.f && v * z >= 0.f && v * z < 1.f) {
      ++num_laid;
      EXPECT_NEAR(depth_(x, y), z, 1e-4f);
      EXPECT_NEAR(normal_(x, y).x, u * z / 0.5f, 1e-3f);
      EXPECT_NEAR(normal_(x, y).z, (z - 2.5f) / 0.5f, 1e-3f);
      EXPECT_EQ(provenance_(x, y),
                static_cast<uint8_t>(Provenance::kInterpolated));
    } else {
      EXPECT_EQ(depth_(x, y), kWall);
      EXPECT_EQ(normal_(x, y).z, -1.f);
      EXPECT_EQ(provenance_(x, y), static_cast<uint8_t>(Provenance::kMeasured));
    }
  });
  EXPECT_GT(num_laid, 150);
}

TEST_F(ApplyCylindersTest, KeepsWhatWasMeasuredBeforeIt) {
  const auto guessed = static_cast<uint8_t>(Provenance::kGuessed);
  depth_(kBefore, 18) = 1.97f;  // 1.2 u in front of it is 1.976.
  depth_(kBefore, 19) = 1.98f;
  depth_(kBefore, 20) = 1.9f;
  provenance_(kBefore, 20) = guessed;
  depth_(kBefore, 21) = 0.f;
  provenance_(kBefore, 21) = static_cast<uint8_t>(Provenance::kNone);
  depth_(kBefore, 22) = 1.9f;
  provenance_(kBefore, 22) = static_cast<uint8_t>(Provenance::kRegionPlane);
  Lay({MakeCylinder(2.5f, 0.5f)});
  EXPECT_EQ(depth_(kBefore, 18), 1.97f);
  EXPECT_EQ(provenance_(kBefore, 18),
            static_cast<uint8_t>(Provenance::kMeasured));
  EXPECT_EQ(depth_(kBefore, 22), 1.9f);
  for (const int y : {19, 20, 21}) {
    EXPECT_NEAR(depth_(kBefore, y), 2.f, 1e-4f);
  }
}

TEST_F(ApplyCylindersTest, KeepsWhatOtherViewsConfirmOnDistinctTexture) {
  const uint8_t distinct =
      MeasurementFlags::Pack(false, Confirmation::kDistinct);
  ratings_(kBefore, 18) = distinct;
  ratings_(kBefore, 19) = MeasurementFlags::Pack(true, Confirmation::kWeak);
  // Close to the outline, which is 8 pixels from the middle.
  ratings_(kBefore + 8, 20) = distinct;
  depth_(kBefore, 21) = 2.02f;
  ratings_(kBefore, 21) = distinct;
  Lay({MakeCylinder(2.5f, 0.5f)});
  EXPECT_EQ(depth_(kBefore, 18), kWall);
  EXPECT_NEAR(depth_(kBefore, 19), 2.f, 1e-4f);
  EXPECT_LT(depth_(kBefore + 8, 20), 2.5f);
  EXPECT_NEAR(depth_(kBefore, 21), 2.f, 1e-4f);
}

TEST_F(ApplyCylindersTest, LaysTheNearestOfTwo) {
  const CameraCylinder near = MakeCylinder(1.5f, 0.1f);
  const CameraCylinder far = MakeCylinder(3.f, 0.5f);
  const std::vector<std::vector<CameraCylinder>> orders = {{near, far},
                                                           {far, near}};
  for (const std::vector<CameraCylinder>& order : orders) {
    std::fill(depth_.begin(), depth_.end(), kWall);
    Lay(order);
    EXPECT_NEAR(depth_(kBefore, 20), 1.4f, 1e-4f);
    EXPECT_LT(std::abs(depth_(kBefore + 4, 20) - 2.6f), 0.1f);
  }
}

TEST_F(ApplyCylindersTest, VariancesAreThoseOfTheCylinderWhereItIsSeen) {
  CameraCylinder cylinder = MakeCylinder(2.5f, 0.5f);
  cylinder.covariance.row2.z = 0.03f * 0.03f;
  Lay({cylinder});
  const Image<float> variances = variances_.ToHost();
  EXPECT_EQ(variances(5, 20), 0.f);
  EXPECT_NEAR(std::sqrt(variances(kBefore, 20)), 0.03f, 1e-4f);
  EXPECT_GT(variances(kBefore + 7, 20), variances(kBefore, 20));
}

}  // namespace
}  // namespace tsar
