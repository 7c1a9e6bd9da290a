// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/photometric_detail.h"

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// In pixels of disparity.
constexpr float kOff = 0.15f;
constexpr float kRight = 0.05f;
constexpr int kMargin = 40;

// A drawn wall whose depth in the composed map is slightly wrong.
class RestoreDetailTest : public testing::Test {
 protected:
  RestoreDetailTest() : device_(CreateTestDevice(2)) {
    SyntheticViewsOptions options;
    options.width = 384;
    options.height = 288;
    drawn_ = MakeSyntheticViews(options);
    const ViewData& reference = drawn_.views[0];
    resolution_.error_per_depth =
        1.f / static_cast<float>(0.3 * reference.camera.fx);
    depth_ = Image<float>(options.width, options.height);
    for (size_t i = 0; i < depth_.NumPixels(); ++i) {
      depth_.Data()[i] =
          DepthAtOffset(drawn_.truth.Data()[i], kOff, resolution_);
    }
  }

  Image<float> Restore(std::vector<const ViewData*> sources,
                       Provenance provenance = Provenance::kMeasured) const {
    const int width = depth_.Width();
    const int height = depth_.Height();
    ComposedMap composed;
    composed.map.depth = DeviceImage<float>(*device_, depth_);
    composed.map.normal = DeviceImage<Vec3f>(
        *device_, Image<Vec3f>(width, height, drawn_.wall.normal));
    composed.provenance = DeviceImage<uint8_t>(
        *device_,
        Image<uint8_t>(width, height, static_cast<uint8_t>(provenance)));
    RestoreDetail(DeviceReference(drawn_.views[0], *device_),
                  UploadViews(sources, *device_),
                  resolution_,
                  &composed,
                  *device_);
    return composed.map.depth.ToHost();
  }
  // The error of a depth, in pixels of disparity.
  float Offset(const Image<float>& depth, int x, int y) const {
    return (1.f / depth(x, y) - 1.f / drawn_.truth(x, y)) /
           resolution_.error_per_depth;
  }
  bool IsBare(int x, int y) const {
    return SyntheticViews::IsBare(
        drawn_.views[0].camera.GetIntrinsics().Ray(x, y));
  }
  // Whether the pixels around it at this distance are all bare, or none.
  bool IsAmid(bool bare, int x, int y, int margin) const {
    return IsBare(x - margin, y - margin) == bare &&
           IsBare(x + margin, y - margin) == bare &&
           IsBare(x - margin, y + margin) == bare &&
           IsBare(x + margin, y + margin) == bare;
  }

  std::unique_ptr<Device> device_;
  SyntheticViews drawn_;
  DepthResolution resolution_;
  Image<float> depth_;
};

TEST_F(RestoreDetailTest, MovesTexturedPixelsToWhereTheImagesAgree) {
  const Image<float> restored = Restore(drawn_.Sources());
  int num_textured = 0;
  int num_right = 0;
  // All sources see the middle.
  ForEachPixel(kMargin,
               restored.Width() - kMargin,
               kMargin,
               restored.Height() - kMargin,
               [&](int x, int y) {
                 ASSERT_LT(std::abs(Offset(restored, x, y)), kOff + kRight)
                     << x << ", " << y;
                 if (IsAmid(false, x, y, 6)) {
                   ++num_textured;
                   num_right +=
                       std::abs(Offset(restored, x, y)) < kRight ? 1 : 0;
                 }
               });
  EXPECT_GT(num_textured, 30000);
  EXPECT_GT(num_right, 0.9 * num_textured);
}

TEST_F(RestoreDetailTest, LeavesBarePixels) {
  const Image<float> restored = Restore(drawn_.Sources());
  int num_bare = 0;
  ForEachPixel(restored.Width(), restored.Height(), [&](int x, int y) {
    if (IsAmid(true, x, y, 3)) {
      ++num_bare;
      ASSERT_EQ(restored(x, y), depth_(x, y)) << x << ", " << y;
    }
  });
  EXPECT_GT(num_bare, 1000);
}

// Occluded points have other colors.
TEST_F(RestoreDetailTest, AsksNoSourceThatSeesANearerSurface) {
  ViewData& hidden = drawn_.views[1];
  for (float& depth : hidden.depth) {
    depth *= 0.9f;
  }
  const Image<float> restored = Restore(drawn_.Sources());
  EXPECT_EQ(restored(30, 30), depth_(30, 30));
}

TEST_F(RestoreDetailTest, DoesNotFollowASurfaceThatIsFurtherOff) {
  constexpr float kFar = 2.f;
  for (size_t i = 0; i < depth_.NumPixels(); ++i) {
    depth_.Data()[i] = DepthAtOffset(drawn_.truth.Data()[i], kFar, resolution_);
  }
  const Image<float> restored = Restore(drawn_.Sources());
  ForEachPixel(restored.Width(), restored.Height(), [&](int x, int y) {
    ASSERT_GT(Offset(restored, x, y), kFar - 0.81f) << x << ", " << y;
  });
}

}  // namespace
}  // namespace tsar
