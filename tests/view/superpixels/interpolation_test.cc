// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/correlation.h"

#include <algorithm>

#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

class InterpolateHolesTest : public testing::Test {
 protected:
  InterpolateHolesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 80.0)),
        plane_(DrawnPlane({0.6f, -0.4f, -1.f}, 4.f)),
        color_(kWidth, kHeight, {100, 110, 120}),
        depth_(DrawDepth(plane_, camera_)),
        normal_(kWidth, kHeight, plane_.normal) {
    options_.radius = 5.f;
    options_.min_support = 0.35f;
  }

  void EraseBox(int x_begin, int y_begin, int x_end, int y_end) {
    for (int y = y_begin; y < y_end; ++y) {
      for (int x = x_begin; x < x_end; ++x) {
        depth_(x, y) = 0.f;
        normal_(x, y) = {};
      }
    }
  }
  void Fill(int num_iterations, int num_threads = 2) {
    device_ = CreateTestDevice(num_threads);
    DepthNormalImages map;
    map.depth = DeviceImage<float>(*device_, depth_);
    map.normal = DeviceImage<Vec3f>(*device_, normal_);
    filled_ = InterpolateHoles(DeviceCopies(*device_)(color_),
                               camera_.GetIntrinsics(),
                               num_iterations,
                               options_,
                               &map,
                               *device_)
                  .ToHost();
    filled_depth_ = map.depth.ToHost();
    filled_normal_ = map.normal.ToHost();
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Plane plane_;
  Image<Rgb> color_;
  Image<float> depth_;
  Image<Vec3f> normal_;
  WeightedMedianOptions options_;
  Image<uint8_t> filled_;
  Image<float> filled_depth_;
  Image<Vec3f> filled_normal_;
};

TEST_F(InterpolateHolesTest, FillsASmallHoleOnThePlane) {
  const Image<float> expected = depth_;
  EraseBox(40, 30, 45, 34);
  Fill(4);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool hole = x >= 40 && x < 45 && y >= 30 && y < 34;
      ASSERT_EQ(filled_(x, y), hole ? 1 : 0);
      ASSERT_NEAR(filled_depth_(x, y), expected(x, y), 1e-4f * expected(x, y));
      ASSERT_LT(AngleBetween(filled_normal_(x, y), plane_.normal), 0.1f);
    }
  }
}

TEST_F(InterpolateHolesTest, ChangesNoMeasuredPixel) {
  EraseBox(40, 30, 45, 34);
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3) {
      depth_(x, y) *= 1.1f;
    }
  }
  Fill(4);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (depth_(x, y) > 0.f) {
        ASSERT_EQ(filled_depth_(x, y), depth_(x, y));
        ASSERT_EQ(filled_normal_(x, y), normal_(x, y));
      }
    }
  }
}

TEST_F(InterpolateHolesTest, LeavesAreasWithTooLittleSupport) {
  // Depth only in a thin strip at the left.
  EraseBox(4, 0, kWidth, kHeight);
  Fill(4);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 60; x < kWidth; ++x) {
      ASSERT_EQ(filled_depth_(x, y), 0.f);
      ASSERT_EQ(filled_normal_(x, y), Vec3f());
      ASSERT_EQ(filled_(x, y), 0);
    }
  }
}

TEST_F(InterpolateHolesTest, ReadsThePreviousRoundOnly) {
  options_.min_support = 0.f;
  EraseBox(30, 0, kWidth, kHeight);
  Fill(1);
  for (int y = 0; y < kHeight; ++y) {
    // The window reaches five pixels to the right of what is measured; an
    // in-place filter would go on from what it has just filled.
    ASSERT_GT(filled_depth_(34, y), 0.f);
    ASSERT_EQ(filled_depth_(35, y), 0.f);
  }
}

}  // namespace
}  // namespace tsar
