// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/correlation.h"

#include "colmap_tsar/base/random.h"

#include <utility>

#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 80;

class CorrelationTest : public testing::Test {
 protected:
  CorrelationTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        plane_(DrawnPlane({0.3f, -0.2f, -1.f}, 4.f)),
        depth_(DrawDepth(plane_, camera_)),
        outliers_(kWidth, kHeight, 0) {
    Camera source = camera_;
    source.translation.x() = 0.4;
    scale_ = ComputeDisparityScale(camera_, {source});
    Philox random(4, 0, 0);
    for (size_t i = 0; i < depth_.NumPixels(); ++i) {
      if (random.NextBelow(5) == 0) {
        outliers_.Data()[i] = 1;
        // At least a fifth off, to either side.
        const float factor = 1.2f + random.NextFloat();
        depth_.Data()[i] *= random.NextBelow(2) == 0 ? factor : 1.f / factor;
      }
    }
  }

  Image<uint8_t> Refine(const CorrelationOptions& options) {
    const Image<Rgb> color(kWidth, kHeight, {100, 110, 120});
    const Image<Vec3f> normal(kWidth, kHeight, plane_.normal);
    const Image<float> score(kWidth, kHeight, 1.f);
    DeviceImage<uint8_t> reliable(*device_, Image<uint8_t>(kWidth, kHeight, 1));
    const Superpixels superpixels =
        ComputeSuperpixels(on_device_(color), on_device_(score), {}, *device_);
    return RefineByCorrelation({on_device_(depth_), on_device_(normal)},
                               on_device_(score),
                               std::move(reliable),
                               on_device_(color),
                               superpixels,
                               {kWidth, kHeight},
                               camera_,
                               scale_,
                               options,
                               *device_)
        .trusted.ToHost();
  }
  void ExpectOnlyThePlaneIsTrusted(const CorrelationOptions& options) {
    const Image<uint8_t> trusted = Refine(options);
    int num_plane = 0;
    int num_plane_trusted = 0;
    int num_outliers = 0;
    int num_outliers_trusted = 0;
    for (size_t i = 0; i < trusted.NumPixels(); ++i) {
      const int is_trusted = trusted.Data()[i] != 0 ? 1 : 0;
      if (outliers_.Data()[i] != 0) {
        ++num_outliers;
        num_outliers_trusted += is_trusted;
      } else {
        ++num_plane;
        num_plane_trusted += is_trusted;
      }
    }
    EXPECT_GT(num_plane_trusted, 0.98f * num_plane);
    EXPECT_LT(num_outliers_trusted, 0.02f * num_outliers);
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  Camera camera_;
  Plane plane_;
  DisparityScale scale_;
  Image<float> depth_;
  Image<uint8_t> outliers_;
};

TEST_F(CorrelationTest, OutliersLoseTheTrustThatThePlaneKeeps) {
  ExpectOnlyThePlaneIsTrusted({});
}

TEST_F(CorrelationTest, PlanesOrTheMedianAloneTellOutliersToo) {
  CorrelationOptions median;
  median.use_superpixel_planes = false;
  ExpectOnlyThePlaneIsTrusted(median);
  CorrelationOptions planes;
  planes.use_weighted_median = false;
  ExpectOnlyThePlaneIsTrusted(planes);
}

TEST_F(CorrelationTest, TrustsNoPixelWithoutADepth) {
  for (int x = 0; x < kWidth; ++x) {
    depth_(x, 40) = 0.f;
  }
  const Image<uint8_t> trusted = Refine({});
  for (int x = 0; x < kWidth; ++x) {
    ASSERT_EQ(trusted(x, 40), 0);
  }
}

TEST_F(CorrelationTest, GivesTheSameBytesAgain) {
  const Image<uint8_t> first = Refine({});
  const Image<uint8_t> second = Refine({});
  EXPECT_TRUE(std::equal(first.begin(), first.end(), second.begin()));
}

}  // namespace
}  // namespace tsar
