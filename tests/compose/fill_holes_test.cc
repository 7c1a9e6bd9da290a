// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_map.h"

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;
constexpr auto kInterpolated = static_cast<uint8_t>(Provenance::kInterpolated);

class FillHolesTest : public testing::Test {
 protected:
  FillHolesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 80.0)),
        plane_(DrawnPlane({0.6f, -0.4f, -1.f}, 4.f)),
        color_(kWidth, kHeight, {100, 110, 120}),
        depth_(DrawDepth(plane_, camera_)),
        normal_(kWidth, kHeight, plane_.normal) {
    // A radius of five pixels.
    options_.window_radius = 81;
  }

  void EraseBox(int x_begin, int y_begin, int x_end, int y_end) {
    ForEachPixel(x_begin, x_end, y_begin, y_end, [&](int x, int y) {
      depth_(x, y) = 0.f;
      normal_(x, y) = {};
    });
  }
  void Fill(int num_iterations) {
    ComposedMap map;
    map.map.depth = DeviceImage<float>(*device_, depth_);
    map.map.normal = DeviceImage<Vec3f>(*device_, normal_);
    map.provenance =
        DeviceImage<uint8_t>(*device_, Image<uint8_t>(kWidth, kHeight));
    FillHoles(DeviceCopies(*device_)(color_),
              camera_.GetIntrinsics(),
              options_,
              num_iterations,
              &map,
              *device_);
    filled_ = map.provenance.ToHost();
    filled_depth_ = map.map.depth.ToHost();
    filled_normal_ = map.map.normal.ToHost();
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Plane plane_;
  Image<Rgb> color_;
  Image<float> depth_;
  Image<Vec3f> normal_;
  RefineOptions options_;
  Image<uint8_t> filled_;
  Image<float> filled_depth_;
  Image<Vec3f> filled_normal_;
};

TEST_F(FillHolesTest, FillsASmallHoleOnThePlane) {
  const Image<float> expected = depth_;
  EraseBox(40, 30, 45, 34);
  Fill(4);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    const bool hole = x >= 40 && x < 45 && y >= 30 && y < 34;
    ASSERT_EQ(filled_(x, y), hole ? kInterpolated : 0);
    ASSERT_NEAR(filled_depth_(x, y), expected(x, y), 1e-4f * expected(x, y));
    ASSERT_LT(AngleBetween(filled_normal_(x, y), plane_.normal), 0.1f);
  });
}

TEST_F(FillHolesTest, ChangesNoMeasuredPixel) {
  EraseBox(40, 30, 45, 34);
  for (int y = 0; y < kHeight; y += 3) {
    for (int x = 0; x < kWidth; x += 3) {
      depth_(x, y) *= 1.1f;
    }
  }
  Fill(4);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    if (depth_(x, y) > 0.f) {
      ASSERT_EQ(filled_depth_(x, y), depth_(x, y));
      ASSERT_EQ(filled_normal_(x, y), normal_(x, y));
    }
  });
}

TEST_F(FillHolesTest, LeavesAreasWithTooLittleSupport) {
  // Depth only in a thin strip at the left.
  EraseBox(4, 0, kWidth, kHeight);
  Fill(4);
  ForEachPixel(60, kWidth, 0, kHeight, [&](int x, int y) {
    ASSERT_EQ(filled_depth_(x, y), 0.f);
    ASSERT_EQ(filled_normal_(x, y), Vec3f());
    ASSERT_EQ(filled_(x, y), 0);
  });
}

}  // namespace
}  // namespace tsar
