// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/curved_surface.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

// Its inverse depth is 0.25 in the middle, the ray (0.1, -0.2, 1).
CurvedSurface Bowl() {
  return {0.1f, -0.2f, 0.5f, {0.25f, 0.03f, -0.02f, 0.04f, 0.01f, -0.03f}};
}

Vec3f PointOn(const CurvedSurface& surface, float x, float y) {
  const Vec3f ray{x, y, 1.f};
  return ray * surface.TangentAt(ray).Depth(ray);
}

TEST(CurvedSurfaceTest, HasTheDepthOfThePolynomial) {
  EXPECT_NEAR(PointOn(Bowl(), 0.1f, -0.2f).z, 4.f, 1e-5f);
  // u = 1, v = -2.
  const float inverse_depth = 0.25f + 0.03f + 0.04f + 0.04f - 0.02f - 0.12f;
  EXPECT_NEAR(PointOn(Bowl(), 0.6f, -1.2f).z, 1.f / inverse_depth, 1e-4f);
}

TEST(CurvedSurfaceTest, TheTangentTouchesTheSurface) {
  const CurvedSurface surface = Bowl();
  const Plane tangent = surface.TangentAt({0.3f, 0.1f, 1.f});
  ASSERT_TRUE(tangent.Valid());
  EXPECT_NEAR(Norm(tangent.normal), 1.f, 1e-6f);
  EXPECT_LT(Dot(tangent.normal, {0.3f, 0.1f, 1.f}), 0.f);
  constexpr float kStep = 0.01f;
  const Vec3f along_x = PointOn(surface, 0.3f + kStep, 0.1f) -
                        PointOn(surface, 0.3f - kStep, 0.1f);
  const Vec3f along_y = PointOn(surface, 0.3f, 0.1f + kStep) -
                        PointOn(surface, 0.3f, 0.1f - kStep);
  EXPECT_NEAR(Dot(Normalized(along_x), tangent.normal), 0.f, 1e-3f);
  EXPECT_NEAR(Dot(Normalized(along_y), tangent.normal), 0.f, 1e-3f);
}

TEST(CurvedSurfaceTest, WithoutSecondOrderItIsAPlane) {
  CurvedSurface surface = Bowl();
  for (int i = 3; i < 6; ++i) {
    surface.coefficients[i] = 0.f;
  }
  const Plane here = surface.TangentAt({0.f, 0.f, 1.f});
  const Plane there = surface.TangentAt({0.7f, -0.4f, 1.f});
  EXPECT_NEAR(Norm(here.normal - there.normal), 0.f, 1e-6f);
  EXPECT_NEAR(here.offset, there.offset, 1e-5f);
}

TEST(CurvedSurfaceTest, RaysThatDoNotMeetItHaveNoTangent) {
  CurvedSurface surface;
  EXPECT_FALSE(surface.TangentAt({0.f, 0.f, 1.f}).Valid());
  // Beyond u = 1 the surface lies behind the camera.
  surface.coefficients[0] = 1.f;
  surface.coefficients[1] = -1.f;
  EXPECT_TRUE(surface.TangentAt({0.9f, 0.f, 1.f}).Valid());
  EXPECT_FALSE(surface.TangentAt({1.f, 0.f, 1.f}).Valid());
  EXPECT_FALSE(surface.TangentAt({1.5f, 0.f, 1.f}).Valid());
}

}  // namespace
}  // namespace tsar
