// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/samples.h"

#include "colmap_tsar/base/random.h"

#include <vector>

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
  for (int y = 0; y < kMapSize; ++y) {
    for (int x = 0; x < kMapSize; ++x) {
      const int column = ReducedRaster::FromMap(x, kMapSize, kSize);
      const int row = ReducedRaster::FromMap(y, kMapSize, kSize);
      if (reliable(x, y) && depth(x, y) > 0.f &&
          score(x, y) > best(column, row)) {
        best(column, row) = score(x, y);
        const Vec3f ray = kIntrinsics.Ray(x, y);
        expected(column, row) = {ray.x, ray.y, depth(x, y)};
      }
    }
  }
  const Image<RayDepth> samples = SampleMeasurements(on_device(depth),
                                                     on_device(score),
                                                     on_device(reliable),
                                                     kIntrinsics,
                                                     {kSize, kSize},
                                                     *device)
                                      .ToHost();
  for (size_t i = 0; i < samples.NumPixels(); ++i) {
    EXPECT_EQ(samples.Data()[i], expected.Data()[i]) << i;
  }
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
  // Labels without a sign name the same planes by numbers from 0 on.
  Image<uint16_t> numbers(10, 10);
  for (size_t i = 0; i < numbers.NumPixels(); ++i) {
    numbers.Data()[i] = static_cast<uint16_t>(labels.Data()[i] + 1);
  }
  const Buffer<Plane> numbered(
      *device, std::vector<Plane>{Plane(), left, Plane(), right});
  const Image<Plane> by_number =
      PlanesOfLabels(on_device(numbers), numbered, *device).ToHost();
  for (size_t i = 0; i < raster.NumPixels(); ++i) {
    ASSERT_EQ(by_number.Data()[i].normal, raster.Data()[i].normal) << i;
    ASSERT_EQ(by_number.Data()[i].offset, raster.Data()[i].offset) << i;
  }
  const PlaneRaster map{raster.View(), camera.GetIntrinsics(), 40, 30};
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 24; ++x) {
      ASSERT_EQ(map.At(x, y).normal, left.normal);
      ASSERT_EQ(map.At(x, y).offset, left.offset);
    }
    for (int x = 24; x < 32; ++x) {
      ASSERT_FALSE(map.At(x, y).Valid());
    }
    for (int x = 32; x < 40; ++x) {
      ASSERT_EQ(map.At(x, y).normal, right.normal);
      ASSERT_EQ(map.At(x, y).offset, right.offset);
    }
  }
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
