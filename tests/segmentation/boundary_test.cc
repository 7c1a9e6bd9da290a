// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/segmentation/boundary_test.h"

#include <utility>

#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr float kDepth = 4.f;

// A region of 20 x 10 pixels with 56 on its border, and a plane that faces the
// camera.
class BoundaryTest : public testing::Test {
 protected:
  BoundaryTest()
      : device_(Device::CreateCpu(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 50.0)) {
    Image<uint8_t> edges(kWidth, kHeight, 1);
    for (int y = 10; y < 20; ++y) {
      for (int x = 10; x < 30; ++x) {
        edges(x, y) = 0;
      }
    }
    regions_ = FindRegions(std::as_const(edges).View(), 100, *device_);
  }

  // Around the region, and nowhere else.
  void DrawSurroundings(float depth) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool is_inside = x >= 10 && x < 30 && y >= 10 && y < 20;
        depth_(x, y) = is_inside ? 0.f : depth;
      }
    }
  }
  bool Stands(float max_gap) const {
    std::vector<SupportedPlane> planes(kMaxPlanesPerRegion);
    planes[0].plane = {{0.f, 0.f, -1.f}, kDepth};
    RegionPlanes fits{{}, Buffer<SupportedPlane>(*device_, planes)};
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth_, camera_));
    RejectByBoundary(regions_,
                     samples.View(),
                     camera_.GetIntrinsics(),
                     max_gap,
                     *device_,
                     &fits);
    return fits.planes.ToHost()[0].plane.Valid();
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Regions regions_;
  Image<float> depth_{kWidth, kHeight, 0.f};
};

TEST_F(BoundaryTest, ComparesTheMeanGapInTheUnitOfTheDepths) {
  for (const float gap : {0.05f, -0.05f}) {
    DrawSurroundings(kDepth + gap);
    EXPECT_TRUE(Stands(0.051f));
    EXPECT_FALSE(Stands(0.049f));
  }
}

TEST_F(BoundaryTest, OneThingInFrontCountsInFull) {
  // It touches 9 of the 56 pixels on the border, or 6 by half: a mean of about
  // 0.16 of its distance from the plane.
  DrawSurroundings(kDepth);
  EXPECT_TRUE(Stands(0.001f));
  for (int y = 20; y < 30; ++y) {
    for (int x = 15; x < 24; ++x) {
      depth_(x, y) = kDepth - 1.f;
    }
  }
  EXPECT_FALSE(Stands(0.13f));
  EXPECT_TRUE(Stands(0.19f));
}

TEST_F(BoundaryTest, OnlyNeighboursOfTheBorderCount) {
  // Inside the region and two pixels outside of it are others.
  DrawSurroundings(0.f);
  for (int x = 5; x < 35; ++x) {
    depth_(x, 15) = x > 11 && x < 28 ? 1.f : 0.f;
    depth_(x, 22) = 1.f;
  }
  EXPECT_TRUE(Stands(0.001f));
  depth_(20, 20) = kDepth + 0.5f;
  EXPECT_FALSE(Stands(0.49f));
  EXPECT_TRUE(Stands(0.51f));
}

}  // namespace
}  // namespace tsar
