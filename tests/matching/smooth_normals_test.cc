// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/plane_maps.h"

#include <cmath>

#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 36;
constexpr Vec3f kTilt = {0.3f, -0.2f, -1.f};

class SmoothNormalsTest : public testing::Test {
 protected:
  SmoothNormalsTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        depth_(DrawDepth(DrawnPlane(kTilt, 3.f), camera_)),
        normal_(kWidth, kHeight, Normalized(kTilt)) {}

  // Turns every normal by up to about ten degrees.
  void AddNoise() {
    Philox random(1, 0, 0);
    const auto draw = [&] { return 0.2f * (2.f * random.NextFloat() - 1.f); };
    for (Vec3f& normal : normal_) {
      normal = Normalized(normal + Vec3f{draw(), draw(), draw()});
    }
  }
  Image<Vec3f> Smooth() {
    return SmoothNormals(camera_.GetIntrinsics(),
                         on_device_(depth_),
                         on_device_(normal_),
                         *device_)
        .ToHost();
  }
  static float MeanError(const Image<Vec3f>& normals, const Vec3f& truth) {
    float sum = 0.f;
    for (const Vec3f& normal : normals) {
      sum += AngleBetween(normal, truth);
    }
    return sum / normals.NumPixels();
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  Camera camera_;
  Image<float> depth_;
  Image<Vec3f> normal_;
};

TEST_F(SmoothNormalsTest, ComesNearerToTheTruth) {
  AddNoise();
  const Vec3f truth = Normalized(kTilt);
  const float before = MeanError(normal_, truth);
  ASSERT_GT(before, 5.f);
  const Image<Vec3f> smoothed = Smooth();
  // The mean of 25 has a fifth of the error.
  EXPECT_LT(MeanError(smoothed, truth), before / 3.5f);
  for (const Vec3f& normal : smoothed) {
    ASSERT_NEAR(Norm(normal), 1.f, 1e-5f);
  }
}

TEST_F(SmoothNormalsTest, IsTheMeanOfTheWindow) {
  // Both are within reach of (20, 20), but only one of (22, 20).
  const Vec3f turned = Normalized(kTilt + Vec3f{0.2f, 0.f, 0.f});
  normal_(19, 20) = turned;
  normal_(21, 21) = turned;
  const Image<Vec3f> smoothed = Smooth();
  const auto mean = [&](int num_turned) {
    return Normalized((25.f - num_turned) * Normalized(kTilt) +
                      static_cast<float>(num_turned) * turned);
  };
  EXPECT_LT(AngleBetween(smoothed(20, 20), mean(2)), 0.02f);
  EXPECT_LT(AngleBetween(smoothed(22, 20), mean(1)), 0.02f);
  EXPECT_LT(AngleBetween(smoothed(24, 24), mean(0)), 0.02f);
}

TEST_F(SmoothNormalsTest, DoesNotBlurAnEdgeBetweenTwoPlanes) {
  // A roof: the planes meet in the middle column and are 80 degrees apart.
  const Vec3f left = Normalized(Vec3f{-0.84f, 0.f, -1.f});
  const Vec3f right = Normalized(Vec3f{0.84f, 0.f, -1.f});
  const Image<float> left_depth = DrawDepth(DrawnPlane(left, 3.f), camera_);
  const Image<float> right_depth = DrawDepth(DrawnPlane(right, 3.f), camera_);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const bool is_left = x < kWidth / 2;
    depth_(x, y) = is_left ? left_depth(x, y) : right_depth(x, y);
    normal_(x, y) = is_left ? left : right;
  });
  const Image<Vec3f> smoothed = Smooth();
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    ASSERT_LT(AngleBetween(smoothed(x, y), normal_(x, y)), 0.05f)
        << x << ", " << y;
  });
}

TEST_F(SmoothNormalsTest, KeepsThoseWithoutDepthAndDoesNotUseThem) {
  const Vec3f turned = Normalized(kTilt + Vec3f{0.3f, 0.f, 0.f});
  depth_(20, 20) = 0.f;
  normal_(20, 20) = turned;
  depth_(21, 20) = 0.f;
  normal_(21, 20) = {};
  const Image<Vec3f> smoothed = Smooth();
  EXPECT_EQ(smoothed(20, 20), turned);
  EXPECT_EQ(smoothed(21, 20), Vec3f{});
  EXPECT_LT(AngleBetween(smoothed(19, 20), Normalized(kTilt)), 0.05f);
}

TEST_F(SmoothNormalsTest, DoesNotDependOnTheUnitOfLength) {
  AddNoise();
  const Image<Vec3f> expected = Smooth();
  for (float& depth : depth_) {
    depth *= 1024.f;
  }
  const Image<Vec3f> scaled = Smooth();
  EXPECT_TRUE(SameBytes(scaled, expected));
}

}  // namespace
}  // namespace tsar
