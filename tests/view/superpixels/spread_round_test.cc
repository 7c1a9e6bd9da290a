// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/trust.h"

#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr Vec3f kFacing{0.f, 0.f, -1.f};
constexpr int kWidth = 5;

// A row of pixels. A disparity is 100 / depth, and the gate 10 wide for a score
// of 1.
class SpreadRoundTest : public testing::Test {
 protected:
  SpreadRoundTest() : device_(CreateTestDevice(1)) {
    scale_.factor = 100.f;
    const float own[] = {2.f, 2.1f, 4.f, 0.f, 4.f};
    const float score[] = {1.f, 1.f, 1.f, 1.f, 0.f};
    for (int x = 0; x < kWidth; ++x) {
      own_(x, 0) = own[x];
      score_(x, 0) = score[x];
    }
  }

  // Sets trusted_ and depth_. planes: may be empty.
  void Spread(const Image<Plane>& planes,
              const WeightedMedianOptions* filter,
              bool readmit) {
    const Image<Vec3f> normal(kWidth, 1, kFacing);
    const Image<Rgb> color(kWidth, 1, {100, 110, 120});
    DepthNormalImages map =
        CopyMap({on_device_(own_), on_device_(normal)}, *device_);
    DeviceImage<uint8_t> trusted(*device_, trusted_);
    SpreadRound({on_device_(planes), {1.f, 1.f, 0.f, 0.f}, kWidth, 1},
                on_device_(color),
                filter,
                {on_device_(own_),
                 on_device_(score_),
                 scale_,
                 10.f,
                 readmit},
                &map,
                trusted.View(),
                *device_);
    trusted_ = trusted.ToHost();
    depth_ = map.depth.ToHost();
  }
  void Expect(const Image<float>& image, const float (&expected)[kWidth]) {
    for (int x = 0; x < kWidth; ++x) {
      EXPECT_FLOAT_EQ(image(x, 0), expected[x]) << x;
    }
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  DisparityScale scale_;
  Image<float> own_{kWidth, 1};
  Image<float> score_{kWidth, 1};
  Image<uint8_t> trusted_{kWidth, 1, 1};
  Image<float> depth_;
};

TEST_F(SpreadRoundTest, WhatPassesTheGateTakesTheDepthOfThePlane) {
  // 4 is 25 of disparity off; without a score, nothing is.
  Spread(Image<Plane>(kWidth, 1, Plane{kFacing, 2.f}), nullptr, true);
  Expect(depth_, {2.f, 2.f, 0.f, 0.f, 2.f});
  for (int x = 0; x < kWidth; ++x) {
    EXPECT_EQ(trusted_(x, 0), depth_(x, 0) > 0.f ? 1 : 0) << x;
  }
}

TEST_F(SpreadRoundTest, WhatWasRejectedStaysSoUnlessReadmitted) {
  trusted_(0, 0) = 0;
  Spread(Image<Plane>(kWidth, 1, Plane{kFacing, 2.f}), nullptr, false);
  Expect(depth_, {0.f, 2.f, 0.f, 0.f, 2.f});
}

TEST_F(SpreadRoundTest, WithoutAPlaneTrustedNeighborsSpread) {
  // Of depths 2, 2.1 and 4 the median is 2.1 for the first two pixels; those
  // that are not trusted have no say, but may take it.
  own_(4, 0) = 4.f;
  trusted_(4, 0) = 0;
  score_(4, 0) = 0.1f;
  WeightedMedianOptions filter;
  filter.radius = 5.f;
  filter.spatial_sigma = 100.f;
  Spread({}, &filter, true);
  Expect(depth_, {2.1f, 2.1f, 0.f, 0.f, 2.1f});
}

}  // namespace
}  // namespace tsar
