// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_criterion.h"

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <cmath>

#include "tests/scene/surfaces/curved_surfaces_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(CurvedSurfacesTest, APlaneStaysAPlane) {
  const Plane plane = DrawnPlane({0.3f, 0.2f, -1.f}, 4.f);
  for (const double noise : {0.0, 0.1, 0.3, 0.6}) {
    Measure([&](const Vec3f& ray) { return plane.Depth(ray); }, noise);
    MakeFacets(kNumColumns, kNumRows);
    ExpectNothing();
    MakeFacets();
    ExpectNothing();
  }
}

TEST_F(CurvedSurfacesTest, ASlightBendMayBeAnErrorThatAllOfAWallHasInCommon) {
  Measure([](const Vec3f& ray) {
    return 4.f + 4.f * kPixel * 0.4f * (ray.x * ray.x + ray.y * ray.y);
  });
  MakeFacets(kNumColumns / 2, kNumRows);
  ExpectNothing();
  options_.min_improvement = 0.f;
  EXPECT_EQ(Find().surfaces.size(), 1u);
}

TEST_F(CurvedSurfacesTest, ACreaseStaysTwoPlanes) {
  const Plane left = DrawnPlane({-0.4f, 0.f, -1.f}, 4.f);
  const Plane right = DrawnPlane({0.4f, 0.f, -1.f}, 4.f);
  for (const double noise : {0.0, 0.3}) {
    Measure(
        [&](const Vec3f& ray) {
          return ray.x < 0.f ? left.Depth(ray) : right.Depth(ray);
        },
        noise);
    MakeFacets(kNumColumns / 2, kNumRows);
    ExpectNothing();
  }
}

TEST_F(CurvedSurfacesTest, TwoWallsBehindEachOtherStayApart) {
  Measure([](const Vec3f& ray) { return ray.x < 0.f ? 4.f : 5.f; });
  MakeFacets(kNumColumns / 2, kNumRows);
  ExpectNothing();
}

TEST_F(CurvedSurfacesTest, NoiseIsNoSurface) {
  Measure([](const Vec3f&) { return 4.f; }, 10.0);
  ExpectNothing();
}

TEST_F(CurvedSurfacesTest, LeavesPlanesThatItDoesNotReplace) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(6, 4, 9, 7);
  labeled_.planes = {DrawnPlane({0.f, 0.f, -1.f}, 4.f)};
  const int inside = 5 * kNumColumns + 7;
  SetLabel(inside, 0);
  labeled_.evidence[inside] = LabelEvidence::kCarried;
  const CurvedView view = Find();
  EXPECT_EQ(view.labels[inside], -1);
  EXPECT_EQ(view.evidence[inside], LabelEvidence::kCarried);
  EXPECT_GE(view.labels[inside + 1], 0);
}

TEST_F(CurvedSurfacesTest, DoesNotReachBeyondWhatWasMeasured) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(8, 0, kNumColumns - 1, kNumRows - 1);
  const CurvedView view = Find();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(view.labels[s] >= 0, s % kNumColumns < 8);
  }
}

TEST_F(CurvedSurfacesTest, AFewMeasurementsAreNoSurface) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(2, 0, kNumColumns - 1, kNumRows - 1);
  Clear(0, 1, 1, kNumRows - 1);
  ExpectNothing();
  Clear(0, 0, 1, 0);
  ExpectNothing();
}

TEST_F(CurvedSurfacesTest, WhatBendsTooFarIsNoSurface) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, true); });
  MakeFacets();
  options_.max_sagitta = 0.03f;
  for (const CurvedSurface& surface : Find().surfaces) {
    const float* c = surface.coefficients;
    EXPECT_LE(std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5]), 0.03f * c[0]);
  }
  options_.max_sagitta = 0.f;
  ExpectNothing();
}

}  // namespace
}  // namespace tsar
