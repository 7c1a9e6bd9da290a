// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/plane.h"

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Plane, IsInvalidByDefault) {
  EXPECT_FALSE(Plane().Valid());
  EXPECT_EQ(Plane().Depth({0.f, 0.f, 1.f}), 0.f);
}

TEST(Plane, FromPointPassesThroughThePoint) {
  const Vec3f ray{0.25f, -0.5f, 1.f};
  const Plane plane =
      Plane::FromPoint(ray, 4.f, Normalized({0.2f, 0.3f, -1.f}));
  ASSERT_TRUE(plane.Valid());
  EXPECT_NEAR(plane.Depth(ray), 4.f, 1e-5f);
}

TEST(Plane, FromPointWithANormalAwayFromTheCameraIsInvalid) {
  EXPECT_FALSE(Plane::FromPoint({0.f, 0.f, 1.f}, 4.f, {0.f, 0.f, 1.f}).Valid());
  EXPECT_FALSE(Plane::FromPoint({0.f, 0.f, 1.f}, 4.f, Vec3f{}).Valid());
}

TEST(Plane, FromPointsFacesTheCameraInEitherOrder) {
  const Vec3f a{-1.f, -1.f, 5.f};
  const Vec3f b{1.f, -1.f, 6.f};
  const Vec3f c{0.f, 1.f, 5.5f};
  for (const Plane& plane :
       {Plane::FromPoints(a, b, c), Plane::FromPoints(a, c, b)}) {
    ASSERT_TRUE(plane.Valid());
    EXPECT_LT(Dot(plane.normal, a), 0.f);
    EXPECT_NEAR(Norm(plane.normal), 1.f, 1e-6f);
    for (const Vec3f& point : {a, b, c}) {
      EXPECT_NEAR(Dot(plane.normal, point) + plane.offset, 0.f, 1e-5f);
    }
  }
}

TEST(Plane, FromPointsOnALineIsInvalidAtEveryScale) {
  for (const float scale : {1e-3f, 1.f, 1e3f}) {
    const Vec3f a = scale * Vec3f{0.f, 0.f, 4.f};
    const Vec3f b = scale * Vec3f{1.f, 1.f, 5.f};
    const Vec3f c = scale * Vec3f{2.f, 2.f, 6.f};
    EXPECT_FALSE(Plane::FromPoints(a, b, c).Valid());
    EXPECT_FALSE(Plane::FromPoints(a, a, b).Valid());
    EXPECT_FALSE(Plane::FromPoints(a, a, a).Valid());
    EXPECT_TRUE(Plane::FromPoints(a, b, scale * Vec3f{2.f, -2.f, 6.f}).Valid());
  }
}

TEST(Plane, HasNoDepthBehindOrAlongTheRay) {
  // A floor one unit below: rays that go up or level never meet it.
  const Plane floor{{0.f, -1.f, 0.f}, 1.f};
  EXPECT_NEAR(floor.Depth({0.f, 0.5f, 1.f}), 2.f, 1e-6f);
  EXPECT_EQ(floor.Depth({0.f, 0.f, 1.f}), 0.f);
  EXPECT_EQ(floor.Depth({0.f, 1e-5f, 1.f}), 0.f);
  EXPECT_EQ(floor.Depth({0.f, -0.5f, 1.f}), 0.f);
}

TEST(RelativeDistance, IsAFractionOfDepthAtEveryScale) {
  const Plane wall = DrawnPlane({0.f, 0.f, -1.f}, 5.f);
  EXPECT_NEAR(RelativeDistance(wall, {0.3f, 0.2f, 5.f}), 0.f, 1e-6f);
  EXPECT_NEAR(RelativeDistance(wall, {0.3f, 0.2f, 5.5f}), 0.5f / 5.5f, 1e-6f);
  const Plane far_wall = DrawnPlane({0.f, 0.f, -1.f}, 5000.f);
  EXPECT_NEAR(
      RelativeDistance(far_wall, {0.3f, 0.2f, 5500.f}), 0.5f / 5.5f, 1e-6f);
}

}  // namespace
}  // namespace tsar
