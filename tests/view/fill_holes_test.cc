// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/compose.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kSize = 21;
constexpr int kMiddle = kSize / 2;

// Fills an image with one measured pixel in its middle.
RefinedMaps FillAroundOnePixel(const RefineOptions& options) {
  const auto device = CreateTestDevice(1);
  const Image<Rgb> color(kSize, kSize, {100, 110, 120});
  Image<float> depth(kSize, kSize, 0.f);
  Image<Vec3f> normal(kSize, kSize);
  Image<uint8_t> provenance(kSize, kSize, 0);
  depth(kMiddle, kMiddle) = 4.f;
  normal(kMiddle, kMiddle) = {0.f, 0.f, -1.f};
  provenance(kMiddle, kMiddle) = static_cast<uint8_t>(Provenance::kMeasured);
  ComposedMap map;
  map.map.depth = DeviceImage<float>(*device, depth);
  map.map.normal = DeviceImage<Vec3f>(*device, normal);
  map.provenance = DeviceImage<uint8_t>(*device, provenance);
  FillHoles(DeviceCopies(*device)(color),
            Intrinsics{20.f, 20.f, 10.f, 10.f},
            options,
            /*num_iterations=*/1,
            &map,
            *device);
  RefinedMaps maps;
  maps.depth = map.map.depth.ToHost();
  maps.provenance = map.provenance.ToHost();
  return maps;
}

TEST(FillHoles, LeavesWideHoles) {
  const RefinedMaps maps = FillAroundOnePixel({});
  EXPECT_EQ(maps.depth(kMiddle, kMiddle), 4.f);
  EXPECT_EQ(maps.provenance(kMiddle, kMiddle),
            static_cast<uint8_t>(Provenance::kMeasured));
  EXPECT_EQ(maps.depth(kMiddle + 3, kMiddle), 0.f);
  EXPECT_EQ(maps.provenance(kMiddle + 3, kMiddle),
            static_cast<uint8_t>(Provenance::kNone));
}

TEST(Download, TiltsNormalsThatFaceAwayAndNoOthers) {
  const auto device = CreateTestDevice(1);
  const Intrinsics intrinsics{2.f, 2.f, 1.f, 0.f};
  // The rays are (-0.5, 0, 1), (0, 0, 1) and (0.5, 0, 1).
  Image<Vec3f> normal(3, 1);
  normal(1, 0) = {0.6f, 0.f, -0.8f};
  normal(2, 0) = Normalized(Vec3f{1.f, 0.2f, -0.49f});
  ComposedMap map;
  map.map.depth = DeviceImage<float>(*device, Image<float>(3, 1, 4.f));
  map.map.normal = DeviceImage<Vec3f>(*device, normal);
  map.provenance = DeviceImage<uint8_t>(*device, Image<uint8_t>(3, 1));
  RefinedMaps maps;
  const DeviceImage<float> confidence(*device, Image<float>(3, 1));
  Download(map, confidence, intrinsics, &maps);
  for (int x = 0; x < 2; ++x) {
    EXPECT_EQ(maps.normal(x, 0).x, normal(x, 0).x);
    EXPECT_EQ(maps.normal(x, 0).y, normal(x, 0).y);
    EXPECT_EQ(maps.normal(x, 0).z, normal(x, 0).z);
  }
  const Vec3f& tilted = maps.normal(2, 0);
  EXPECT_LT(Dot(tilted, intrinsics.Ray(2.f, 0.f)), 0.f);
  EXPECT_NEAR(Norm(tilted), 1.f, 1e-6f);
  // By less than a degree.
  EXPECT_GT(Dot(tilted, normal(2, 0)), 0.9998f);
}

}  // namespace
}  // namespace tsar
