// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/patch_match.h"

#include "colmap_tsar/matching/plane_maps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/matching/patch_match_fixture.h"
#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(PatchMatchTest, FindsThePlane) {
  TexturedPlane scene = Scene(kTilt);
  const Image<Plane> drawn = Draw().ToHost();
  ASSERT_LT(Compare(scene, drawn).share, 0.1f);
  const HostHypotheses found = Run(scene, Images(scene), Draw());
  ExpectFound(scene, found.planes);
  ForEachPixel(
      kMargin, kWidth - kMargin, kMargin, kHeight - kMargin, [&](int x, int y) {
        ASSERT_LT(found.costs(x, y), 0.2f) << x << ", " << y;
      });
}

TEST_F(PatchMatchTest, FindsSlantedPlanesWithWideWindowsAndTheGeometricTerm) {
  TexturedPlane slanted = Scene(kSlant);
  ExpectFound(slanted, Run(slanted, Images(slanted), Draw()).planes);
  TexturedPlane scene = Scene(kTilt);
  ExpectFound(scene, Run(scene, scene.Sources(), Draw()).planes);
  options_.window_radius = 8.f;
  ExpectFound(scene, Run(scene, Images(scene), Draw()).planes);
}

TEST_F(PatchMatchTest, IgnoresExposureAndViewsOfSomethingElse) {
  TexturedPlane scene = Scene(kTilt);
  for (float& value : scene.SourceGray(1)) {
    value = 0.5f * value + 60.f;
  }
  TexturedPlane other = BareScene(kTilt);
  other.AddSource(SourceCamera(camera_, {0.7, 0.2, 0.5}, -0.4));
  scene.AddSource(SourceCamera(camera_, {0.3, 0.2, 0.0}, -0.1));
  scene.SourceGray(4) = other.SourceGray(0);
  ExpectFound(scene, Run(scene, Images(scene), Draw()).planes);
}

TEST_F(PatchMatchTest, TakesMoreThan32Sources) {
  options_.num_iterations = 3;
  TexturedPlane scene = BareScene(kTilt);
  // They look away: only the last four of forty see the plane.
  for (int i = 0; i < 36; ++i) {
    scene.AddSource(SourceCamera(camera_, {0.01 * i, 0.0, 0.0}, 3.14159265));
  }
  AddSources(&scene);
  const SourceViews sources = Images(scene);
  ASSERT_EQ(sources.Size(), 40);
  EXPECT_GT(Compare(scene, Run(scene, sources, Draw()).planes).share, 0.9f);
}

TEST_F(PatchMatchTest, DependsOnTheStreamAlone) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_iterations = 2;
  const SourceViews sources = Images(scene);
  const HostHypotheses first = Run(scene, sources, Draw(), 1);
  const HostHypotheses again = Run(scene, sources, Draw(), 1);
  const HostHypotheses other = Run(scene, sources, Draw(), 2);
  EXPECT_TRUE(SameBytes(first.planes, again.planes));
  EXPECT_TRUE(SameBytes(first.costs, again.costs));
  EXPECT_FALSE(SameBytes(first.planes, other.planes));
}

TEST_F(PatchMatchTest, KeepsTheTruth) {
  TexturedPlane scene = Scene(kTilt);
  const HostHypotheses kept = Run(scene, Images(scene), TruePlanes(scene));
  const Accuracy accuracy = Compare(scene, kept.planes);
  EXPECT_EQ(accuracy.share, 1.f);
  EXPECT_LT(accuracy.median_depth_error, 5e-4f);
  EXPECT_LT(accuracy.median_normal_error, 2.f);
}

TEST_F(PatchMatchTest, DoesNotDependOnTheUnitOfLength) {
  TexturedPlane scene = Scene(kTilt);
  const HostHypotheses expected = Run(scene, Images(scene), Draw());
  const auto scaled = [&](float scale) {
    options_.depth_min = 1.5f * scale;
    options_.depth_max = 6.f * scale;
    return Run(scene, Images(scene, scale), Draw());
  };
  // Powers of two change no mantissa.
  const HostHypotheses by_1024 = scaled(1024.f);
  // Others round, so that a few pixels select another plane.
  const HostHypotheses by_1000 = scaled(1000.f);
  int num_near = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const Vec3f ray = intrinsics_.Ray(x, y);
    const float depth = expected.planes(x, y).Depth(ray);
    ASSERT_EQ(by_1024.planes(x, y).Depth(ray), 1024.f * depth);
    ASSERT_EQ(by_1024.planes(x, y).normal, expected.planes(x, y).normal);
    ASSERT_EQ(by_1024.costs(x, y), expected.costs(x, y));
    const float by_1000_depth = by_1000.planes(x, y).Depth(ray);
    num_near += std::abs(by_1000_depth / (1000.f * depth) - 1.f) < 2e-3f;
  });
  EXPECT_GT(num_near, kWidth * kHeight * 95 / 100);
  ExpectFound(scene, expected.planes);
}

TEST_F(PatchMatchTest, StartsWithTheTwoSourcesThatMatchBest) {
  options_.num_iterations = 0;
  TexturedPlane scene = Scene(kTilt);
  // Two negatives and two that look away.
  for (int i = 0; i < 2; ++i) {
    scene.AddSource(SourceCamera(camera_, {0.1, 0.0, 0.0}, 3.14159265));
    for (float& value : scene.SourceGray(i)) {
      value = 255.f - value;
    }
  }
  const Image<float> costs = Run(scene, Images(scene), TruePlanes(scene)).costs;
  // The middle is seen by both of the others.
  ForEachPixel(22, 42, 18, 30, [&](int x, int y) {
    ASSERT_LT(costs(x, y), 0.1f) << x << ", " << y;
  });
}

TEST_F(PatchMatchTest, FindsNormalsFarFromThoseItHas) {
  TexturedPlane scene = Scene(kTilt);
  options_.num_past_iterations = 100;
  const Image<Vec3f> wrong(
      kWidth, kHeight, Normalized(Vec3f{-1.f, 0.5f, -0.6f}));
  const DeviceImage<Vec3f> normal(*device_, wrong);
  const HostHypotheses found =
      Run(scene,
          Images(scene),
          PlanesFromMaps(
              intrinsics_, scene.Reference().depth, normal.View(), *device_));
  const Accuracy accuracy = Compare(scene, found.planes);
  // Here normals are drawn at random until one fits: 1e-3 with these draws.
  EXPECT_LT(accuracy.median_normal_error, 10.f);
  EXPECT_LT(accuracy.median_depth_error, 2e-3f);
}

TEST_F(PatchMatchTest, FollowsTheDepthsOfSourcesWithoutTexture) {
  TexturedPlane scene = Scene(kTilt);
  Image<float> depth = scene.Depth();
  ForEachPixel(18, 46, 12, 36, [&](int x, int y) {
    scene.Gray()(x, y) = 128.f;
    depth(x, y) *= 1.3f;
  });
  const auto median_error = [&](const Image<Plane>& planes) {
    std::vector<float> errors;
    // Whose windows have no texture.
    ForEachPixel(23, 41, 17, 31, [&](int x, int y) {
      errors.push_back(std::abs(planes(x, y).Depth(intrinsics_.Ray(x, y)) /
                                    scene.Depth()(x, y) -
                                1.f));
    });
    std::nth_element(
        errors.begin(), errors.begin() + errors.size() / 2, errors.end());
    return errors[errors.size() / 2];
  };
  const auto wrong_planes = [&] {
    return PlanesFromMaps(intrinsics_,
                          DeviceCopies(*device_)(depth),
                          scene.Reference().normal,
                          *device_);
  };
  ASSERT_NEAR(median_error(wrong_planes().ToHost()), 0.3f, 1e-3f);
  const float with_depths =
      median_error(Run(scene, scene.Sources(), wrong_planes()).planes);
  EXPECT_LT(with_depths, 0.02f);
  // Without depths, the wrong planes stay.
  const float without_depths =
      median_error(Run(scene, Images(scene), wrong_planes()).planes);
  EXPECT_GT(without_depths, 0.1f);
}

}  // namespace
}  // namespace tsar
