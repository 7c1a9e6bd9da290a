// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"

#include "tests/matching/patch_match_fixture.h"
#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(PatchMatchTest, DrawsPlanesBetweenTheBounds) {
  const Image<Plane> planes = Draw().ToHost();
  int num_in_nearer_half = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const Vec3f ray = intrinsics_.Ray(x, y);
    const Plane& plane = planes(x, y);
    ASSERT_NEAR(Norm(plane.normal), 1.f, 1e-5f);
    ASSERT_LE(Dot(plane.normal, ray), 0.f);
    // A plane may be seen too nearly edge-on to have a depth.
    const float slope = -Dot(plane.normal, ray);
    if (slope > 1e-2f) {
      const float depth = plane.Depth(ray);
      ASSERT_GE(depth, 1.5f * (1.f - 1e-4f));
      ASSERT_LE(depth, 6.f * (1.f + 1e-4f));
      // 1 / 2.4 is the middle of 1 / 1.5 and 1 / 6.
      num_in_nearer_half += depth < 2.4f ? 1 : 0;
    }
  });
  EXPECT_NEAR(num_in_nearer_half, kWidth * kHeight / 2, kWidth * kHeight / 20);
  EXPECT_TRUE(SameBytes(planes, Draw().ToHost()));
  EXPECT_FALSE(SameBytes(planes, Draw(2).ToHost()));
}

// Sums over these numbers of sources round one way or the other; planes that
// cost the same must not win by that.
class UntexturedTest : public PatchMatchTest,
                       public testing::WithParamInterface<int> {
 protected:
  TexturedPlane UntexturedScene() {
    TexturedPlane scene = BareScene(kTilt);
    for (int i = 0; i < GetParam(); ++i) {
      scene.AddSource(SourceCamera(camera_, {0.05 * i, 0.1, 0.0}, -0.015 * i));
    }
    scene.Gray() = Image<float>(kWidth, kHeight, 128.f);
    return scene;
  }
};

TEST_P(UntexturedTest, KeepsThePlanesWithoutTextureAndDepths) {
  TexturedPlane scene = UntexturedScene();
  for (int i = 0; i < GetParam(); ++i) {
    scene.SourceDepth(i) = Image<float>(kWidth, kHeight, 0.f);
  }
  const HostHypotheses kept = Run(scene, scene.Sources(), Draw());
  EXPECT_TRUE(SameBytes(kept.planes, Draw().ToHost()));
  for (const float cost : kept.costs) {
    ASSERT_NEAR(cost, kMaxCost + 0.6f, 1e-5f);
  }
}

INSTANTIATE_TEST_SUITE_P(Sources,
                         UntexturedTest,
                         testing::Values(1, 2, 3, 5, 7, 10, 12, 19));

TEST_F(PatchMatchTest, FillsPixelsWithoutAPlane) {
  TexturedPlane scene = Scene(kTilt);
  Image<float> depth = scene.Depth();
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    if ((x / 4 + y / 4) % 2 == 0) {
      depth(x, y) = 0.f;
    }
  });
  const HostHypotheses filled =
      Run(scene,
          Images(scene),
          PlanesFromMaps(intrinsics_,
                         DeviceCopies(*device_)(depth),
                         scene.Reference().normal,
                         *device_));
  EXPECT_EQ(Compare(scene, filled.planes).share, 1.f);
}

TEST_F(PatchMatchTest, TakesOnePixel) {
  TexturedPlane scene(
      DrawnPlane(kTilt, 3.f), SyntheticCamera(1, 1, 5), *device_);
  scene.AddSource(SourceCamera(SyntheticCamera(1, 1, 5), {0.1, 0.0, 0.0}, 0.0));
  const HostHypotheses found = Run(scene, Images(scene), TruePlanes(scene));
  ASSERT_EQ(found.planes.NumPixels(), 1u);
  EXPECT_TRUE(found.planes(0, 0).Valid());
}

TEST_F(PatchMatchTest, KeepsPlanesBetweenTheBounds) {
  TexturedPlane scene = Scene(kSlant);
  // Only a strip of the plane lies between them.
  options_.depth_min = 2.9f;
  options_.depth_max = 3.1f;
  const HostHypotheses found = Run(scene, Images(scene), Draw());
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const float depth = found.planes(x, y).Depth(intrinsics_.Ray(x, y));
    ASSERT_GT(depth, 2.9f * (1.f - 1e-4f)) << x << ", " << y;
    ASSERT_LT(depth, 3.1f * (1.f + 1e-4f)) << x << ", " << y;
  });
}

}  // namespace
}  // namespace tsar
