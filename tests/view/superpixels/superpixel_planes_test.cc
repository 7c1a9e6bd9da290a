// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/superpixel_planes.h"

#include "colmap_tsar/base/random.h"

#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// One superpixel that covers the whole map.
class SuperpixelPlanesTest : public testing::Test {
 protected:
  SuperpixelPlanesTest()
      : device_(CreateTestDevice(1)),
        camera_(SyntheticCamera(40, 40, 60.0)),
        plane_(DrawnPlane({0.5f, -0.3f, -1.f}, 4.f)) {
    Camera source = camera_;
    source.translation.x() = 0.4;
    scale_ = ComputeDisparityScale(camera_, {source});
  }

  Plane Fit(const Image<float>& depth) const {
    const DeviceImage<int> labels(*device_, Image<int>(40, 40, 0));
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth, camera_));
    return FitSuperpixelPlanes(GroupPixels(labels.View(), 1, *device_),
                               samples.View(),
                               camera_.GetIntrinsics(),
                               scale_,
                               /*min_support=*/0.3f,
                               {},
                               *device_)
        .ToHost()[0];
  }
  void ExpectPlane(const Plane& fit, const Plane& expected) const {
    ASSERT_TRUE(fit.Valid());
    EXPECT_LT(AngleBetween(fit.normal, expected.normal), 0.2f);
    EXPECT_NEAR(fit.offset, expected.offset, 2e-3f * expected.offset);
  }
  // Keeps this share of the pixels, drawn at random.
  void Thin(float share, Image<float>* depth) const {
    Philox random(9, 0, 0);
    for (float& z : *depth) {
      z = random.NextFloat() < share ? z : 0.f;
    }
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Plane plane_;
  DisparityScale scale_;
};

TEST_F(SuperpixelPlanesTest, NeedsReliablePixels) {
  Image<float> enough = DrawDepth(plane_, camera_);
  Thin(0.4f, &enough);
  ExpectPlane(Fit(enough), plane_);
  Image<float> few = DrawDepth(plane_, camera_);
  Thin(0.2f, &few);
  EXPECT_FALSE(Fit(few).Valid());
  EXPECT_FALSE(Fit(Image<float>(40, 40, 0.f)).Valid());
}

TEST_F(SuperpixelPlanesTest, NeedsInliers) {
  Image<float> depth(40, 40);
  Philox random(2, 0, 0);
  for (float& z : depth) {
    z = 1.f + 20.f * random.NextFloat();
  }
  EXPECT_FALSE(Fit(depth).Valid());
}

TEST_F(SuperpixelPlanesTest, RejectsAPlaneThatLeavesTheDepthsItWasFittedTo) {
  // Samples at one side only, on a plane so steep that it is far off in the
  // middle of the superpixel.
  const Plane steep = DrawnPlane({1.f, 0.f, -0.25f}, 2.f);
  Image<float> depth = DrawDepth(steep, camera_);
  ForEachPixel(13, 40, 0, 40, [&](int x, int y) { depth(x, y) = 0.f; });
  const float nearest = depth(0, 20);
  const float farthest = depth(12, 20);
  ASSERT_GT(std::min(nearest, farthest), 0.f);
  ASSERT_TRUE(2.f > 1.2f * std::max(nearest, farthest) ||
              2.f < 0.8f * std::min(nearest, farthest));
  EXPECT_FALSE(Fit(depth).Valid());
}

}  // namespace
}  // namespace tsar
