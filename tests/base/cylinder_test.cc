// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/cylinder.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr float kTolerance = 1e-5f;

// Upright, two units before the camera, of radius ½.
constexpr Cylinder kUpright = {{0.f, 1.f, 2.f}, {0.f, -1.f, 0.f}, 0.5f};

TEST(CylinderTest, IsMetInFront) {
  Cylinder::Hit hit;
  ASSERT_TRUE(kUpright.Meets({0.f, 0.2f, 1.f}, &hit));
  EXPECT_NEAR(hit.depth, 1.5f, kTolerance);
  EXPECT_NEAR(hit.height, 0.7f, kTolerance);
  EXPECT_NEAR(hit.normal.x, 0.f, kTolerance);
  EXPECT_NEAR(hit.normal.y, 0.f, kTolerance);
  EXPECT_NEAR(hit.normal.z, -1.f, kTolerance);
}

TEST(CylinderTest, PointsLieOnItAndNormalsAwayFromItsAxis) {
  Cylinder tilted = {{0.3f, -0.2f, 4.f}, {}, 0.7f};
  tilted.axis = Normalized({0.3f, 1.f, -0.4f});
  int num_hits = 0;
  for (float x = -0.5f; x < 0.5f; x += 0.01f) {
    const Vec3f ray = {x, 0.1f, 1.f};
    Cylinder::Hit hit;
    if (!tilted.Meets(ray, &hit)) {
      continue;
    }
    ++num_hits;
    const Vec3f from_begin = ray * hit.depth - tilted.point;
    EXPECT_NEAR(Dot(from_begin, tilted.axis), hit.height, kTolerance);
    const Vec3f from_axis = from_begin - tilted.axis * hit.height;
    EXPECT_NEAR(Norm(from_axis), tilted.radius, kTolerance);
    EXPECT_NEAR(Norm(hit.normal * tilted.radius - from_axis), 0.f, 1e-4f);
    EXPECT_LE(Dot(hit.normal, ray), 0.f);
  }
  EXPECT_GT(num_hits, 20);
}

TEST(CylinderTest, IsNotMetBesideIt) {
  Cylinder::Hit hit;
  // The outline of a circle of radius ½ at a distance of 2.
  const float outline = 0.5f / std::sqrt(4.f - 0.25f);
  EXPECT_TRUE(kUpright.Meets({0.999f * outline, 0.f, 1.f}, &hit));
  EXPECT_FALSE(kUpright.Meets({1.001f * outline, 0.f, 1.f}, &hit));
}

TEST(CylinderTest, IsNotMetFromWithinBehindOrAlong) {
  Cylinder::Hit hit;
  EXPECT_FALSE((Cylinder{{0.f, 0.f, 0.3f}, {0.f, -1.f, 0.f}, 0.5f}.Meets(
      {0.f, 0.f, 1.f}, &hit)));
  EXPECT_FALSE((Cylinder{{0.f, 0.f, -2.f}, {0.f, -1.f, 0.f}, 0.5f}.Meets(
      {0.f, 0.f, 1.f}, &hit)));
  EXPECT_FALSE((Cylinder{{1.f, 0.f, 2.f}, {0.f, 0.f, 1.f}, 0.5f}.Meets(
      {0.f, 0.f, 1.f}, &hit)));
}

}  // namespace
}  // namespace tsar
