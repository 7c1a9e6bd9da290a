// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/plane_maps.h"

#include "tests/matching/patch_match_fixture.h"
#include "tests/matching/textured_plane.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(PatchMatchTest, MapsComeBackFromPlanes) {
  TexturedPlane scene = BareScene(kTilt);
  Image<float>& depth = scene.Depth();
  depth(3, 4) = 0.f;
  depth(5, 4) = 7.5f;
  const DeviceImage<Plane> planes = TruePlanes(scene);
  EXPECT_FALSE(planes.ToHost()(3, 4).Valid());
  const PlaneMaps maps = MapsFromPlanes(intrinsics_, planes.View(), *device_);
  const Image<float> found_depth = maps.depth.ToHost();
  const Image<Vec3f> found_normal = maps.normal.ToHost();
  const Vec3f normal = Normalized(kTilt);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x == 3 && y == 4) {
        EXPECT_EQ(found_depth(x, y), 0.f);
        EXPECT_EQ(found_normal(x, y), Vec3f{});
        continue;
      }
      ASSERT_NEAR(found_depth(x, y), depth(x, y), 1e-5f * depth(x, y));
      ASSERT_EQ(found_normal(x, y), normal);
    }
  }
}

TEST_F(PatchMatchTest, MapsHaveNothingWhereThePlaneIsNotSeen) {
  // A floor below the camera, of which pixels above the horizon see nothing.
  Image<Plane> planes(kWidth, kHeight, {{0.f, -1.f, 0.f}, 1.5f});
  const DeviceImage<Plane> on_device(*device_, planes);
  const PlaneMaps maps =
      MapsFromPlanes(intrinsics_, on_device.View(), *device_);
  const Image<float> depth = maps.depth.ToHost();
  const Image<Vec3f> normal = maps.normal.ToHost();
  EXPECT_EQ(depth(10, kHeight / 2 - 5), 0.f);
  EXPECT_EQ(normal(10, kHeight / 2 - 5), Vec3f{});
  EXPECT_NEAR(depth(10, kHeight / 2 + 5), 1.5f / 0.05f, 1e-3f);
  EXPECT_EQ(normal(10, kHeight / 2 + 5), (Vec3f{0.f, -1.f, 0.f}));
}

TEST_F(PatchMatchTest, ResizesPlanesByPlace) {
  const DeviceImage<Plane> drawn = Draw();
  const Image<Plane> planes = drawn.ToHost();
  const auto resize =
      [&](const DeviceImage<Plane>& from, int width, int height) {
        return ResizePlanes(from.View(), width, height, *device_);
      };
  EXPECT_TRUE(SameBytes(resize(drawn, kWidth, kHeight).ToHost(), planes));
  // Every pixel of a larger image of this size has its own there.
  const DeviceImage<Plane> larger = resize(drawn, 2 * kWidth, 3 * kHeight);
  EXPECT_TRUE(SameBytes(resize(larger, kWidth, kHeight).ToHost(), planes));
  const Image<Plane> on_larger = larger.ToHost();
  for (int y = 0; y < 3 * kHeight; ++y) {
    for (int x = 0; x < 2 * kWidth; ++x) {
      ASSERT_EQ(on_larger(x, y).normal, planes(x / 2, y / 3).normal);
    }
  }
  // Sizes without a common divisor: the first and the last stay at the ends.
  const Image<Plane> odd = resize(drawn, 41, 29).ToHost();
  EXPECT_EQ(odd(0, 0).normal, planes(0, 0).normal);
  EXPECT_EQ(odd(40, 28).normal, planes(kWidth - 1, kHeight - 1).normal);
  EXPECT_EQ(odd(20, 14).normal, planes(kWidth / 2, kHeight / 2).normal);
  EXPECT_EQ(resize(drawn, 1, 1).ToHost()(0, 0).normal,
            planes(kWidth / 2, kHeight / 2).normal);
}

}  // namespace
}  // namespace tsar
