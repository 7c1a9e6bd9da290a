// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/samples.h"

#include "colmap_tsar/base/random.h"

#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr Intrinsics kIntrinsics{50.f, 50.f, 10.f, 10.f};

TEST(SampleMeasurements, TakesTheBestReliablePixelWithItsOwnRay) {
  const auto device = CreateTestDevice(2);
  DeviceCopies on_device(*device);
  constexpr int kMapSize = 20;
  constexpr int kSize = 7;
  Image<float> depth(kMapSize, kMapSize);
  Image<float> score(kMapSize, kMapSize);
  Image<uint8_t> reliable(kMapSize, kMapSize);
  Philox random(1, 0, 0);
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    depth.Data()[i] = random.NextBelow(4) == 0 ? 0.f : 1.f + random.NextFloat();
    score.Data()[i] = random.NextFloat();
    reliable.Data()[i] = random.NextBelow(3) == 0 ? 0 : 1;
  }
  Image<RayDepth> expected(kSize, kSize);
  Image<float> best(kSize, kSize, -1.f);
  ForEachPixel(kMapSize, kMapSize, [&](int x, int y) {
    const int column = ReducedRaster::FromMap(x, kMapSize, kSize);
    const int row = ReducedRaster::FromMap(y, kMapSize, kSize);
    if (reliable(x, y) && depth(x, y) > 0.f &&
        score(x, y) > best(column, row)) {
      best(column, row) = score(x, y);
      const Vec3f ray = kIntrinsics.Ray(x, y);
      expected(column, row) = {ray.x, ray.y, depth(x, y)};
    }
  });
  const Image<RayDepth> samples = SampleMeasurements(on_device(depth),
                                                     on_device(score),
                                                     on_device(reliable),
                                                     kIntrinsics,
                                                     {kSize, kSize},
                                                     *device)
                                      .ToHost();
  EXPECT_TRUE(SameBytes(samples, expected));
}

TEST(PlaneRaster, GivesEachMapPixelItsPlane) {
  const auto device = CreateTestDevice(2);
  DeviceCopies on_device(*device);
  const Camera camera = SyntheticCamera(40, 30, 35.0);
  const Plane left = DrawnPlane({0.5f, 0.2f, -1.f}, 3.f);
  Image<int> labels(10, 10, 0);
  for (int y = 0; y < 10; ++y) {
    labels(6, y) = 1;
    labels(7, y) = -1;
    labels(8, y) = 2;
    labels(9, y) = 2;
  }
  const Plane right = DrawnPlane({0.f, 0.f, -1.f}, 5.f);
  const Buffer<Plane> planes(*device, std::vector<Plane>{left, Plane(), right});
  const DeviceImage<Plane> pixel_planes =
      PlanesOfLabels(on_device(labels), planes, *device);
  const Image<Plane> raster = pixel_planes.ToHost();
  const PlaneRaster map{raster.View(), camera.GetIntrinsics(), 40, 30};
  ForEachPixel(0, 24, 0, 30, [&](int x, int y) {
    ASSERT_EQ(map.At(x, y).normal, left.normal);
    ASSERT_EQ(map.At(x, y).offset, left.offset);
  });
  ForEachPixel(
      24, 32, 0, 30, [&](int x, int y) { ASSERT_FALSE(map.At(x, y).Valid()); });
  ForEachPixel(32, 40, 0, 30, [&](int x, int y) {
    ASSERT_EQ(map.At(x, y).normal, right.normal);
    ASSERT_EQ(map.At(x, y).offset, right.offset);
  });
}

TEST(PlaneRaster, LeavesOutPixelsThatSeeThePlaneFromBehind) {
  const Camera camera = SyntheticCamera(20, 20, 10.0);
  const Image<Plane> floor(20, 20, {{0.f, -1.f, 0.f}, 1.f});
  const PlaneRaster map{floor.View(), camera.GetIntrinsics(), 20, 20};
  EXPECT_FALSE(map.At(5, 3).Valid());
  EXPECT_FALSE(map.At(5, 10).Valid());
  EXPECT_TRUE(map.At(5, 15).Valid());
}

}  // namespace
}  // namespace tsar
