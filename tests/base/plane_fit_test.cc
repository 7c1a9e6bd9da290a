// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/plane_fit.h"

#include "colmap_tsar/base/random.h"

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

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

TEST_F(PlaneRegressionTest, FindsAnExactPlane) {
  const Plane fit = Fit(1.f, 0.f);
  ASSERT_TRUE(fit.Valid());
  EXPECT_LT(AngleBetween(fit.normal, plane_.normal), 0.01f);
  EXPECT_NEAR(fit.offset, plane_.offset, 1e-4f);
}

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
