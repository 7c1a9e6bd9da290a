// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/weighted_median.h"

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 36;

class WeightedMedianTest : public testing::Test {
 protected:
  WeightedMedianTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 40.0)),
        color_(kWidth, kHeight, {100, 110, 120}) {
    Draw(DrawnPlane({0.6f, -0.4f, -1.f}, 4.f), 0, kWidth);
  }

  // Draws the plane into columns [begin, end).
  void Draw(const Plane& plane, int begin, int end) {
    const Image<float> depth = DrawDepth(plane, camera_);
    ForEachPixel(begin, end, 0, kHeight, [&](int x, int y) {
      depth_(x, y) = depth(x, y);
      normal_(x, y) = plane.normal;
    });
  }
  void Erase(int x, int y) {
    depth_(x, y) = 0.f;
    normal_(x, y) = {};
  }
  void Filter(const Image<uint8_t>& where = Image<uint8_t>()) {
    const DepthNormalImages output =
        WeightedMedianFilter({on_device_(depth_), on_device_(normal_)},
                             on_device_(color_),
                             on_device_(where),
                             camera_.GetIntrinsics(),
                             options_,
                             *device_);
    filtered_ = output.depth.ToHost();
    filtered_normal_ = output.normal.ToHost();
  }
  // The filtered map is what was drawn before.
  void ExpectDrawn(const Image<float>& depth,
                   const Image<Vec3f>& normal) const {
    ForEachPixel(kWidth, kHeight, [&](int x, int y) {
      ASSERT_NEAR(filtered_(x, y), depth(x, y), 1e-4f * depth(x, y))
          << x << ", " << y;
      ASSERT_LT(AngleBetween(filtered_normal_(x, y), normal(x, y)), 0.1f);
    });
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  Camera camera_;
  Image<Rgb> color_;
  Image<float> depth_{kWidth, kHeight};
  Image<Vec3f> normal_{kWidth, kHeight};
  WeightedMedianOptions options_;
  Image<float> filtered_;
  Image<Vec3f> filtered_normal_;
};

TEST_F(WeightedMedianTest, LeavesASlantedPlaneWhatItIs) {
  for (const float radius : {1.f, 5.f, 10.f, 40.f}) {
    options_.radius = radius;
    Filter();
    ExpectDrawn(depth_, normal_);
  }
}

TEST_F(WeightedMedianTest, ReplacesOutliers) {
  const Image<float> depth = depth_;
  const Image<Vec3f> normal = normal_;
  for (int y = 2; y < kHeight; y += 9) {
    for (int x = 2; x < kWidth; x += 9) {
      depth_(x, y) *= x % 2 == 0 ? 0.6f : 1.7f;
      normal_(x, y) = {0.f, 0.f, -1.f};
    }
  }
  options_.radius = 5.f;
  Filter();
  ExpectDrawn(depth, normal);
}

TEST_F(WeightedMedianTest, FillsFromItsOwnSideOfAColorEdge) {
  Draw(DrawnPlane({0.f, 0.f, -1.f}, 8.f), 21, kWidth);
  ForEachPixel(21, kWidth, 0, kHeight, [&](int x, int y) {
    color_(x, y) = {200, 190, 180};
  });
  const Image<float> depth = depth_;
  const Image<Vec3f> normal = normal_;
  ForEachPixel(18, 24, 10, 20, [&](int x, int y) { Erase(x, y); });
  Filter();
  ExpectDrawn(depth, normal);
}

TEST_F(WeightedMedianTest, NeedsItsSupport) {
  const Image<float> depth = depth_;
  // A fifth of the columns holds depths.
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    if (x % 5 != 0) {
      Erase(x, y);
    }
  });
  options_.radius = 5.f;
  options_.min_support = 0.1f;
  Filter();
  EXPECT_NEAR(filtered_(22, 18), depth(22, 18), 1e-4f * depth(22, 18));
  options_.min_support = 0.35f;
  Filter();
  EXPECT_EQ(filtered_(22, 18), 0.f);
  EXPECT_EQ(filtered_normal_(22, 18), Vec3f());
}

TEST_F(WeightedMedianTest, ComputesOnlyWhereItIsAsked) {
  Image<uint8_t> where(kWidth, kHeight, 0);
  where(7, 9) = 1;
  where(40, 30) = 255;
  Filter(where);
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    ASSERT_EQ(filtered_(x, y) > 0.f, where(x, y) != 0);
    ASSERT_EQ(filtered_normal_(x, y) == Vec3f(), where(x, y) == 0);
  });
}

TEST_F(WeightedMedianTest, DoesNotDependOnTheScenesScale) {
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    depth_(x, y) *= 1.f + 0.02f * ((x * 5 + y * 3) % 7);
  });
  Filter();
  const Image<float> depth = filtered_;
  for (float& z : depth_) {
    z *= 1024.f;
  }
  Filter();
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    ASSERT_EQ(filtered_(x, y), 1024.f * depth(x, y));
  });
}

}  // namespace
}  // namespace tsar
