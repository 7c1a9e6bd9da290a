// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/region_planes.h"

#include "colmap_tsar/base/random.h"

#include <cmath>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 90;

// One bare region in the middle of the image, on a slanted wall whose
// surroundings are measured.
class RegionPlanesTest : public testing::Test {
 protected:
  RegionPlanesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        wall_(DrawnPlane({0.4f, -0.3f, -1.f}, 4.f)),
        depth_(DrawDepth(wall_, camera_)) {
    Camera source = camera_;
    source.translation.x() = 0.4;
    scale_ = ComputeDisparityScale(camera_, {source});
    Image<uint8_t> edges(kWidth, kHeight, 1);
    ForEachPixel(30, 90, 25, 65, [&](int x, int y) {
      edges(x, y) = 0;
      depth_(x, y) = 0.f;
    });
    regions_ = FindRegions(DeviceCopies(*device_)(edges), 100, *device_);
  }

  bool InRegion(int x, int y) const {
    return x >= 30 && x < 90 && y >= 25 && y < 65;
  }
  std::vector<SupportedPlane> FitAll(
      const RegionPlaneOptions& options = {}) const {
    EXPECT_EQ(regions_.count, 1);
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth_, camera_));
    return FitRegionPlanes(regions_, samples.View(), scale_, options, *device_)
        .planes.ToHost();
  }
  Plane Fit(const RegionPlaneOptions& options = {}) const {
    return FitAll(options)[0].plane;
  }
  Image<Plane> Assign(const RegionPlaneOptions& options = {}) const {
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth_, camera_));
    const RegionPlanes planes =
        FitRegionPlanes(regions_, samples.View(), scale_, options, *device_);
    return AssignRegionPlanes(regions_,
                              planes,
                              samples.View(),
                              camera_.GetIntrinsics(),
                              scale_,
                              options,
                              *device_)
        .ToHost();
  }
  // Frames around the region stand this share of the depth in front of the
  // wall and give 70 % of the rim's samples. Inside there are a few samples of
  // the wall, with the noise that is made of a number in [-0.5, 0.5), and a few
  // wrong ones.
  template <typename Noise>
  Plane DrawFrames(float height, const Noise& make_noise) {
    const Plane frames{wall_.normal, (1.f - height) * wall_.offset};
    const Image<float> wall_depth = DrawDepth(wall_, camera_);
    const Image<float> frame_depth = DrawDepth(frames, camera_);
    Philox random(11, 0, 0);
    ForEachPixel(kWidth, kHeight, [&](int x, int y) {
      const float choice = random.NextFloat();
      const float noise = make_noise(random.NextFloat() - 0.5f);
      if (!InRegion(x, y)) {
        depth_(x, y) = choice < 0.7f ? frame_depth(x, y) : wall_depth(x, y);
      } else if (choice < 0.1f) {
        depth_(x, y) = wall_depth(x, y) * (1.f + noise);
      } else if (choice < 0.12f) {
        depth_(x, y) = wall_depth(x, y) * (0.7f + 0.6f * random.NextFloat());
      }
    });
    return frames;
  }
  void ExpectWall(const Plane& plane) const {
    ASSERT_TRUE(plane.Valid());
    EXPECT_LT(AngleBetween(plane.normal, wall_.normal), 0.3f);
    EXPECT_NEAR(plane.offset, wall_.offset, 5e-3f * wall_.offset);
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Plane wall_;
  DisparityScale scale_;
  Image<float> depth_;
  Regions regions_;
};

TEST_F(RegionPlanesTest, TakesThePlaneOfTheRim) { ExpectWall(Fit()); }

TEST_F(RegionPlanesTest, TakesThePlaneOfItsInside) {
  const Image<float> wall = DrawDepth(wall_, camera_);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    depth_(x, y) = InRegion(x, y) && (x + y) % 2 == 0 ? wall(x, y) : 0.f;
  });
  ExpectWall(Fit());
}

TEST_F(RegionPlanesTest, WithoutARimOnlyItsInsideCounts) {
  RegionPlaneOptions options;
  options.use_core = false;
  ExpectWall(Fit(options));
  options.rim_width = 0;
  EXPECT_FALSE(Fit(options).Valid());
  const Image<float> wall = DrawDepth(wall_, camera_);
  ForEachPixel(
      30, 90, 25, 65, [&](int x, int y) { depth_(x, y) = wall(x, y); });
  ExpectWall(Fit(options));
}

TEST_F(RegionPlanesTest, RejectsARimThatIsNoPlane) {
  Philox random(6, 0, 0);
  for (float& z : depth_) {
    z = z > 0.f ? 2.f + 4.f * random.NextFloat() : 0.f;
  }
  EXPECT_FALSE(Fit().Valid());
}

TEST_F(RegionPlanesTest, DoesNotDependOnTheScenesScale) {
  const Plane plane = Fit();
  for (float& z : depth_) {
    z *= 1000.f;
  }
  scale_.factor *= 1000.f;
  scale_.error_per_depth /= 1000.f;
  const Plane scaled = Fit();
  ASSERT_TRUE(scaled.Valid());
  EXPECT_LT(AngleBetween(scaled.normal, plane.normal), 0.05f);
  EXPECT_NEAR(scaled.offset / 1000.f, plane.offset, 1e-3f * plane.offset);
}

TEST_F(RegionPlanesTest, IsNotBelievedFarFromItsSupport) {
  // Measured only on a short piece of the rim, at the left.
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    if (x >= 30 || y < 35 || y >= 55) {
      depth_(x, y) = 0.f;
    }
  });
  const Image<Plane> pixels = Assign();
  EXPECT_TRUE(pixels(30, 45).Valid());
  EXPECT_FALSE(pixels(80, 45).Valid());
  RegionPlaneOptions trusting;
  trusting.max_extrapolation = 1000.f;
  EXPECT_TRUE(Assign(trusting)(80, 45).Valid());
}

// A wall with a rim of what hangs on it. One tolerance is 0.6 % of the depth.
TEST_F(RegionPlanesTest, ACoreOnTheWallWinsOverFramesAroundIt) {
  for (const float height : {0.015f, 0.05f}) {
    const Plane frames =
        DrawFrames(height, [](float at) { return 6e-3f * at; });
    const Plane plane = Fit();
    ASSERT_TRUE(plane.Valid());
    // Both share a direction, which the frames determine best.
    EXPECT_LT(AngleBetween(plane.normal, frames.normal), 0.1f) << height;
    EXPECT_NEAR(plane.offset, wall_.offset, 1e-3f * wall_.offset) << height;
  }
}

// Cauchy's distribution: half of the samples within 1.5 tolerances, 2.3 times
// denser within one tolerance than between one and three.
TEST_F(RegionPlanesTest, ANoisyCoreOnTheWallWinsOverFramesAroundIt) {
  DrawFrames(0.05f, [](float at) { return 9e-3f * std::tan(3.14f * at); });
  const Plane plane = Fit();
  ASSERT_TRUE(plane.Valid());
  EXPECT_NEAR(plane.offset, wall_.offset, 3e-3f * wall_.offset);
}

TEST_F(RegionPlanesTest, FramesWinOverACoreThatIsEquallyDenseEverywhere) {
  const Plane frames = DrawFrames(0.05f, [](float at) { return 0.2f * at; });
  const Plane plane = Fit();
  ASSERT_TRUE(plane.Valid());
  EXPECT_NEAR(plane.offset, frames.offset, 1e-3f * wall_.offset);
}

// Two walls that meet at the column of the principal point, and no edge there.
class CreasedRegionTest : public RegionPlanesTest {
 protected:
  static constexpr int kCrease = kWidth / 2;

  CreasedRegionTest()
      : left_(DrawnPlane({0.5f, 0.f, -1.f}, 4.f)),
        right_(DrawnPlane({-0.7f, 0.f, -1.f}, 4.f)) {
    const Image<float> left = DrawDepth(left_, camera_);
    const Image<float> right = DrawDepth(right_, camera_);
    ForEachPixel(kWidth, kHeight, [&](int x, int y) {
      const float z = x < kCrease ? left(x, y) : right(x, y);
      depth_(x, y) = (2 * x + y) % 5 == 0 ? z : 0.f;
    });
  }
  void ExpectPlane(const Plane& plane, const Plane& expected) const {
    EXPECT_LT(AngleBetween(plane.normal, expected.normal), 0.3f);
    EXPECT_NEAR(plane.offset, expected.offset, 2e-3f * expected.offset);
  }

  Plane left_;
  Plane right_;
};

TEST_F(CreasedRegionTest, BothPlanesAreFoundAndNoOther) {
  const std::vector<SupportedPlane> planes = FitAll();
  const bool left_first =
      AngleBetween(planes[0].plane.normal, left_.normal) < 10.f;
  ExpectPlane(planes[0].plane, left_first ? left_ : right_);
  ExpectPlane(planes[1].plane, left_first ? right_ : left_);
  EXPECT_FALSE(planes[2].plane.Valid());
  EXPECT_FALSE(planes[3].plane.Valid());
}

TEST_F(CreasedRegionTest, PixelsBesideTheCreaseHaveThePlaneOfTheirSide) {
  const Image<Plane> pixels = Assign();
  ForEachPixel(30, 90, 25, 65, [&](int x, int y) {
    ASSERT_TRUE(pixels(x, y).Valid()) << x << ", " << y;
    if (std::abs(x - kCrease) > 6) {
      const Plane& expected = x < kCrease ? left_ : right_;
      ASSERT_LT(AngleBetween(pixels(x, y).normal, expected.normal), 0.3f)
          << x << ", " << y;
    }
  });
}

}  // namespace
}  // namespace tsar
