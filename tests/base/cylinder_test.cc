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

TEST(CylinderTest, IsIntersectedInFront) {
  Cylinder::Intersection intersection;
  ASSERT_TRUE(kUpright.Intersect({0.f, 0.2f, 1.f}, &intersection));
  EXPECT_NEAR(intersection.depth, 1.5f, kTolerance);
  EXPECT_NEAR(intersection.height, 0.7f, kTolerance);
  EXPECT_NEAR(intersection.normal.x, 0.f, kTolerance);
  EXPECT_NEAR(intersection.normal.y, 0.f, kTolerance);
  EXPECT_NEAR(intersection.normal.z, -1.f, kTolerance);
}

TEST(CylinderTest, PointsLieOnItAndNormalsAwayFromItsAxis) {
  Cylinder tilted = {{0.3f, -0.2f, 4.f}, {}, 0.7f};
  tilted.axis = Normalized({0.3f, 1.f, -0.4f});
  int num_intersections = 0;
  for (float x = -0.5f; x < 0.5f; x += 0.01f) {
    const Vec3f ray = {x, 0.1f, 1.f};
    Cylinder::Intersection intersection;
    if (!tilted.Intersect(ray, &intersection)) {
      continue;
    }
    ++num_intersections;
    const Vec3f from_begin = ray * intersection.depth - tilted.point;
    EXPECT_NEAR(Dot(from_begin, tilted.axis), intersection.height, kTolerance);
    const Vec3f from_axis = from_begin - tilted.axis * intersection.height;
    EXPECT_NEAR(Norm(from_axis), tilted.radius, kTolerance);
    EXPECT_NEAR(
        Norm(intersection.normal * tilted.radius - from_axis), 0.f, 1e-4f);
    EXPECT_LE(Dot(intersection.normal, ray), 0.f);
  }
  EXPECT_GT(num_intersections, 20);
}

TEST(CylinderTest, IsNotIntersectedBesideIt) {
  Cylinder::Intersection intersection;
  // The outline of a circle of radius ½ at a distance of 2.
  const float outline = 0.5f / std::sqrt(4.f - 0.25f);
  EXPECT_TRUE(kUpright.Intersect({0.999f * outline, 0.f, 1.f}, &intersection));
  EXPECT_FALSE(kUpright.Intersect({1.001f * outline, 0.f, 1.f}, &intersection));
}

TEST(CylinderTest, IsNotIntersectedFromWithinBehindOrAlong) {
  Cylinder::Intersection intersection;
  EXPECT_FALSE((Cylinder{{0.f, 0.f, 0.3f}, {0.f, -1.f, 0.f}, 0.5f}.Intersect(
      {0.f, 0.f, 1.f}, &intersection)));
  EXPECT_FALSE((Cylinder{{0.f, 0.f, -2.f}, {0.f, -1.f, 0.f}, 0.5f}.Intersect(
      {0.f, 0.f, 1.f}, &intersection)));
  EXPECT_FALSE((Cylinder{{1.f, 0.f, 2.f}, {0.f, 0.f, 1.f}, 0.5f}.Intersect(
      {0.f, 0.f, 1.f}, &intersection)));
}

}  // namespace
}  // namespace tsar
