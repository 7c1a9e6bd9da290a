// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/reprojection.cuh"

#include <cmath>

#include "tests/matching/textured_plane.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

class LookThroughSourceTest : public testing::Test {
 protected:
  LookThroughSourceTest()
      : camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        depth_(kWidth, kHeight, 2.f) {}

  bool Look(const Camera& source, const Vec3f& point) {
    return LookThroughSource(camera_.GetIntrinsics(),
                             {source.GetIntrinsics(),
                              ComputeRelativePose(camera_, source),
                              {},
                              std::as_const(depth_).View()},
                             point,
                             &seen_);
  }
  // From this far to the right of the reference, looking the same way.
  bool LookFrom(double x, const Vec3f& point) {
    return Look(SourceCamera(camera_, {x, 0.0, 0.0}, 0.0), point);
  }

  Camera camera_;
  Image<float> depth_;
  SeenThroughSource seen_;
};

TEST_F(LookThroughSourceTest, FindsTheSurfaceOfTheSource) {
  // The source sees the point in column 32 - 100 * 0.3 / 3 = 22, and there it
  // has a surface at depth 2, which the reference sees in column 32 + 5.
  ASSERT_TRUE(LookFrom(0.3, {0.f, 0.f, 3.f}));
  EXPECT_NEAR(seen_.point.x, 0.1f, 1e-5f);
  EXPECT_NEAR(seen_.point.y, 0.f, 1e-5f);
  EXPECT_NEAR(seen_.point.z, 2.f, 1e-5f);
  EXPECT_NEAR(seen_.x, 37.f, 1e-3f);
  EXPECT_NEAR(seen_.y, 24.f, 1e-3f);
}

TEST_F(LookThroughSourceTest, ComesBackToThePixelAtTheTruth) {
  const Plane plane = DrawnPlane({0.3f, -0.2f, -1.f}, 3.f);
  const auto device = Device::CreateCpu(1);
  TexturedPlane scene(plane, camera_, *device);
  scene.AddSource(SourceCamera(camera_, {0.4, 0.05, 0.1}, -0.12));
  const Intrinsics intrinsics = camera_.GetIntrinsics();
  const Buffer<SourceView> sources = scene.Sources();
  int num_seen = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec3f ray = intrinsics.Ray(static_cast<float>(x), y);
      if (!LookThroughSource(
              intrinsics, sources.Data()[0], plane.Depth(ray) * ray, &seen_)) {
        continue;
      }
      ++num_seen;
      // Depths are those of the nearest pixel's middle.
      ASSERT_NEAR(seen_.x, x, 0.7f);
      ASSERT_NEAR(seen_.y, y, 0.7f);
      ASSERT_NEAR(Dot(plane.normal, seen_.point) + plane.offset, 0.f, 1e-4f);
      float u = 0.f;
      float v = 0.f;
      intrinsics.Project(seen_.point, &u, &v);
      ASSERT_EQ(u, seen_.x);
      ASSERT_EQ(v, seen_.y);
    }
  }
  EXPECT_GT(num_seen, kWidth * kHeight * 3 / 4);
}

TEST_F(LookThroughSourceTest, TakesTheNearestPixel) {
  depth_ = Image<float>(kWidth, kHeight, 0.f);
  depth_(22, 24) = 2.f;
  // 0.03 in x is one pixel.
  EXPECT_TRUE(LookFrom(0.3, {0.014f, 0.f, 3.f}));
  EXPECT_TRUE(LookFrom(0.3, {-0.014f, 0.f, 3.f}));
  EXPECT_FALSE(LookFrom(0.3, {0.016f, 0.f, 3.f}));
  EXPECT_FALSE(LookFrom(0.3, {-0.016f, 0.f, 3.f}));
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.016f, 3.f}));
  EXPECT_FALSE(LookFrom(0.3, {0.f, -0.016f, 3.f}));
}

TEST_F(LookThroughSourceTest, SeesNothingOutsideOfTheSource) {
  // Columns -0.6, -0.4, 63.4 and 63.6.
  const auto see = [&](float column, float row) {
    return LookFrom(0.0,
                    {0.03f * (column - 0.5f * kWidth),
                     0.03f * (row - 0.5f * kHeight),
                     3.f});
  };
  EXPECT_FALSE(see(-0.6f, 20.f));
  EXPECT_TRUE(see(-0.4f, 20.f));
  EXPECT_TRUE(see(kWidth - 0.6f, 20.f));
  EXPECT_FALSE(see(kWidth - 0.4f, 20.f));
  EXPECT_FALSE(see(20.f, -0.6f));
  EXPECT_TRUE(see(20.f, -0.4f));
  EXPECT_TRUE(see(20.f, kHeight - 0.6f));
  EXPECT_FALSE(see(20.f, kHeight - 0.4f));
  EXPECT_FALSE(see(1e30f, 20.f));
  EXPECT_FALSE(see(NAN, 20.f));
}

TEST_F(LookThroughSourceTest, KnowsTheSizeOfTheSourcesMap) {
  const Camera half = SourceCamera(
      camera_.Resized(kWidth / 2, kHeight / 2), {0.0, 0.0, 0.0}, 0.0);
  depth_ = Image<float>(kWidth / 2, kHeight / 2, 2.f);
  ASSERT_TRUE(Look(half, {0.6f, 0.3f, 3.f}));
  EXPECT_NEAR(seen_.x, 52.f, 1.f);
  EXPECT_NEAR(seen_.y, 34.f, 1.f);
  EXPECT_FALSE(Look(half, {1.f, 0.3f, 3.f}));
}

TEST_F(LookThroughSourceTest, SeesNothingWithoutDepth) {
  depth_(22, 24) = 0.f;
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.f, 3.f}));
  depth_(22, 24) = NAN;
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.f, 3.f}));
  depth_ = Image<float>();
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.f, 3.f}));
}

TEST_F(LookThroughSourceTest, SeesNothingBehindEitherCamera) {
  EXPECT_FALSE(LookFrom(0.3, {0.f, 0.f, -3.f}));
  // From the far side; what it sees at depth 2 lies before the reference, what
  // it sees at depth 5 behind it.
  const Camera opposite = SourceCamera(camera_, {0.0, 0.0, 4.0}, 3.14159265);
  EXPECT_TRUE(Look(opposite, {0.f, 0.f, 3.f}));
  EXPECT_NEAR(seen_.point.z, 2.f, 1e-4f);
  depth_ = Image<float>(kWidth, kHeight, 5.f);
  EXPECT_FALSE(Look(opposite, {0.f, 0.f, 3.f}));
}

}  // namespace
}  // namespace tsar
