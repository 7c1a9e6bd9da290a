// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/base/random.h"

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Plane, FromPointPassesThroughThePoint) {
  const Vec3f ray{0.25f, -0.5f, 1.f};
  const Plane plane =
      Plane::FromPoint(ray, 4.f, Normalized({0.2f, 0.3f, -1.f}));
  ASSERT_TRUE(plane.Valid());
  EXPECT_NEAR(plane.Depth(ray), 4.f, 1e-5f);
}

TEST(Plane, IsInvalidWithoutANormalTowardsTheCamera) {
  EXPECT_FALSE(Plane().Valid());
  EXPECT_EQ(Plane().Depth({0.f, 0.f, 1.f}), 0.f);
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

class PlaneRegressionTest : public testing::Test {
 protected:
  PlaneRegressionTest()
      : camera_(SyntheticCamera(32, 24, 30.0)),
        plane_(DrawnPlane({0.4f, -0.3f, -1.f}, 5.f)) {}

  // noise: the largest relative change of inverse depth.
  Plane Fit(float scale, float noise) const {
    PlaneRegression regression;
    Philox random(1, 2, 3);
    for (const RayDepth& sample :
         ToSamples(DrawDepth(plane_, camera_), camera_)) {
      const float change = noise * (2.f * random.NextFloat() - 1.f);
      regression.Add({sample.x, sample.y, scale * sample.z / (1.f + change)},
                     1.0);
    }
    return regression.Solve();
  }

  Camera camera_;
  Plane plane_;
};

TEST_F(PlaneRegressionTest, AveragesNoise) {
  const Plane fit = Fit(1.f, 0.02f);
  ASSERT_TRUE(fit.Valid());
  EXPECT_LT(AngleBetween(fit.normal, plane_.normal), 1.f);
  EXPECT_NEAR(fit.Depth({0.f, 0.f, 1.f}), 5.f, 0.02f);
}

TEST_F(PlaneRegressionTest, DoesNotDependOnTheScale) {
  const Plane fit = Fit(1.f, 0.02f);
  for (const float scale : {1e-3f, 1e3f}) {
    const Plane scaled = Fit(scale, 0.02f);
    ASSERT_TRUE(scaled.Valid());
    EXPECT_LT(AngleBetween(scaled.normal, fit.normal), 0.01f);
    EXPECT_NEAR(scaled.offset / scale, fit.offset, 1e-3f);
  }
}

TEST_F(PlaneRegressionTest, FollowsTheWeights) {
  PlaneRegression regression;
  const Plane other = DrawnPlane({0.f, 0.f, -1.f}, 9.f);
  for (const RayDepth& sample :
       ToSamples(DrawDepth(plane_, camera_), camera_)) {
    regression.Add(sample, 1.0);
  }
  for (const RayDepth& sample : ToSamples(DrawDepth(other, camera_), camera_)) {
    regression.Add(sample, 1e-6);
  }
  const Plane fit = regression.Solve();
  ASSERT_TRUE(fit.Valid());
  EXPECT_LT(AngleBetween(fit.normal, plane_.normal), 0.01f);
}

TEST(PlaneRegression, NeedsPointsThatSpanAPlane) {
  PlaneRegression none;
  EXPECT_FALSE(none.Solve().Valid());

  PlaneRegression point;
  PlaneRegression line;
  for (int i = 0; i < 20; ++i) {
    point.Add({0.1f, 0.2f, 3.f}, 1.0);
    line.Add({0.05f * i - 0.5f, 0.03f * i - 0.3f, 3.f + 0.1f * i}, 1.0);
  }
  EXPECT_FALSE(point.Solve().Valid());
  EXPECT_FALSE(line.Solve().Valid());
}

}  // namespace
}  // namespace tsar
