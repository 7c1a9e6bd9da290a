// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/planar_prior.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "tests/matching/textured_plane.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;
const Plane kWall = DrawnPlane({0.3f, -0.2f, -1.f}, 3.f);

Intrinsics DrawnIntrinsics() {
  return SyntheticCamera(kWidth, kHeight, 100.0).GetIntrinsics();
}

// Depths of a wall in squares of five pixels at the corners of the image.
Image<float> DepthInTheCorners() {
  const Image<float> wall =
      DrawDepth(kWall, SyntheticCamera(kWidth, kHeight, 100.0));
  Image<float> depth(kWidth, kHeight, 0.f);
  for (const int x0 : {0, kWidth - 6}) {
    for (const int y0 : {0, kHeight - 7}) {
      for (int y = y0; y < y0 + 5; ++y) {
        for (int x = x0; x < x0 + 5; ++x) {
          depth(x, y) = wall(x, y);
        }
      }
    }
  }
  return depth;
}

int CountValid(const Image<Plane>& planes) {
  int num_valid = 0;
  for (const Plane& plane : planes) {
    num_valid += plane.Valid() ? 1 : 0;
  }
  return num_valid;
}

void ExpectOnTheWall(const Image<Plane>& planes, float scale) {
  const Intrinsics intrinsics = DrawnIntrinsics();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (planes(x, y).Valid()) {
        const Vec3f ray = intrinsics.Ray(x, y);
        ASSERT_NEAR(
            planes(x, y).Depth(ray) / (scale * kWall.Depth(ray)), 1.f, 1e-5f)
            << x << ", " << y;
        ASSERT_GT(Dot(planes(x, y).normal, kWall.normal), 0.99999f);
      }
    }
  }
}

TEST(TriangulatePlanesTest, SpansTheSurfaceBetweenDepths) {
  const Image<Plane> planes =
      TriangulatePlanes(DepthInTheCorners(), DrawnIntrinsics());
  // All but a rim outside of the squares' middles.
  EXPECT_GT(CountValid(planes), kWidth * kHeight * 85 / 100);
  EXPECT_TRUE(planes(kWidth / 2, kHeight / 2).Valid());
  EXPECT_FALSE(planes(kWidth - 1, kHeight / 2).Valid());
  ExpectOnTheWall(planes, 1.f);
}

TEST(TriangulatePlanesTest, LeavesNoPixelOutBetweenTriangles) {
  const Image<Plane> planes =
      TriangulatePlanes(DepthInTheCorners(), DrawnIntrinsics());
  for (int y = 8; y < kHeight - 8; ++y) {
    for (int x = 8; x < kWidth - 8; ++x) {
      ASSERT_TRUE(planes(x, y).Valid()) << x << ", " << y;
    }
  }
}

TEST(TriangulatePlanesTest, DoesNotDependOnTheUnitOfLength) {
  for (const float scale : {1e-3f, 1e3f}) {
    Image<float> depth = DepthInTheCorners();
    for (float& value : depth) {
      value *= scale;
    }
    const Image<Plane> planes = TriangulatePlanes(depth, DrawnIntrinsics());
    EXPECT_GT(CountValid(planes), kWidth * kHeight * 85 / 100);
    ExpectOnTheWall(planes, scale);
  }
}

TEST(TriangulatePlanesTest, TakesTheMedianOfASquare) {
  Image<float> depth = DepthInTheCorners();
  // Far off, and the first of its square.
  depth(0, 0) *= 3.f;
  depth(4, 4) *= 0.2f;
  ExpectOnTheWall(TriangulatePlanes(depth, DrawnIntrinsics()), 1.f);
}

TEST(TriangulatePlanesTest, IgnoresSpecks) {
  Image<float> depth = DepthInTheCorners();
  for (int x = 40; x < 45; ++x) {
    depth(x, 40) = 0.5f;
  }
  ExpectOnTheWall(TriangulatePlanes(depth, DrawnIntrinsics()), 1.f);
}

TEST(TriangulatePlanesTest, NeedsThreeSquares) {
  EXPECT_EQ(CountValid(TriangulatePlanes(Image<float>(kWidth, kHeight, 0.f),
                                         DrawnIntrinsics())),
            0);
  Image<float> depth = DepthInTheCorners();
  for (int y = 0; y < kHeight / 2; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      depth(x, y) = 0.f;
    }
  }
  EXPECT_EQ(CountValid(TriangulatePlanes(depth, DrawnIntrinsics())), 0);
}

Image<Plane> FindPlanarPrior(TexturedPlane& scene, Device& device) {
  return TriangulatePlanes(
      FindReliableDepth(scene.Reference(), scene.Sources(), 5.f, device)
          .ToHost(),
      DrawnIntrinsics());
}

// A textured wall without texture in its middle, seen by the reference and two
// sources whose depths there are noise.
TEST(FindReliableDepthTest, SpansABareWall) {
  const std::unique_ptr<Device> device = Device::CreateCpu(2);
  const Camera camera = SyntheticCamera(kWidth, kHeight, 100.0);
  TexturedPlane scene(kWall, camera, *device);
  scene.AddSource(SourceCamera(camera, {0.3, 0.05, 0.0}, -0.09));
  scene.AddSource(SourceCamera(camera, {-0.3, 0.05, 0.0}, 0.09));
  for (int y = 28; y < 44; ++y) {
    for (int x = 30; x < 66; ++x) {
      scene.Gray()(x, y) = 128.f;
      scene.Depth()(x, y) *= 1.f + 0.01f * static_cast<float>((7 * x + y) % 20);
    }
  }
  const Image<Plane> prior = FindPlanarPrior(scene, *device);
  const Vec3f ray = DrawnIntrinsics().Ray(kWidth / 2, kHeight / 2);
  const Plane& middle = prior(kWidth / 2, kHeight / 2);
  ASSERT_TRUE(middle.Valid());
  EXPECT_NEAR(middle.Depth(ray) / kWall.Depth(ray), 1.f, 1e-3f);
}

// Of two sources one has no depth, so that a single one confirms them.
TEST(FindReliableDepthTest, NeedsTwoSourcesIfThereAreTwo) {
  const std::unique_ptr<Device> device = Device::CreateCpu(2);
  const Camera camera = SyntheticCamera(kWidth, kHeight, 100.0);
  TexturedPlane scene(kWall, camera, *device);
  scene.AddSource(SourceCamera(camera, {0.3, 0.05, 0.0}, -0.09));
  const auto count = [&] {
    return CountValid(FindPlanarPrior(scene, *device));
  };
  EXPECT_GT(count(), kWidth * kHeight / 2);
  scene.AddSource(SourceCamera(camera, {-0.3, 0.05, 0.0}, 0.09));
  scene.SourceDepth(1) = Image<float>(kWidth, kHeight, 0.f);
  EXPECT_EQ(count(), 0);
}

TEST(FindReliableDepthTest, TakesWhateverDepthsThereAre) {
  const std::unique_ptr<Device> device = Device::CreateCpu(1);
  const Camera camera = SyntheticCamera(kWidth, kHeight, 100.0);
  TexturedPlane scene(kWall, camera, *device);
  const auto count = [&] {
    return CountValid(FindPlanarPrior(scene, *device));
  };
  EXPECT_EQ(count(), 0);  // Without sources.
  scene.AddSource(SourceCamera(camera, {0.3, 0.05, 0.0}, -0.09));
  for (const float depth : {std::numeric_limits<float>::infinity(),
                            std::numeric_limits<float>::quiet_NaN(),
                            1e38f,
                            -1.f}) {
    scene.Depth() = Image<float>(kWidth, kHeight, depth);
    EXPECT_EQ(count(), 0) << depth;
  }
}

}  // namespace
}  // namespace tsar
