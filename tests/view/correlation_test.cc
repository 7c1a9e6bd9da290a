// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/correlation.h"

#include "colmap_tsar/base/random.h"

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

  Image<uint8_t> Refine(const RefineOptions& options) {
    ViewData reference;
    reference.camera = camera_;
    reference.color = Image<Rgb>(kWidth, kHeight, {100, 110, 120});
    reference.depth = depth_;
    reference.normal = Image<Vec3f>(kWidth, kHeight, plane_.normal);
    ViewData source = reference;
    source.camera.translation.x() = 0.4;
    const DeviceViews views(reference,
                            UploadViews({&source}, *device_),
                            *device_,
                            /*denoise=*/false);
    const DeviceImage<float> score(*device_, Image<float>(kWidth, kHeight, 1));
    const Superpixels superpixels = ComputeSuperpixels(
        views.RasterColor(), score.View(), options.superpixel_size, *device_);
    return RefineByCorrelation(
               views,
               score.View(),
               DeviceImage<uint8_t>(*device_,
                                    Image<uint8_t>(kWidth, kHeight, 1)),
               superpixels,
               options,
               /*image_id=*/0,
               *device_)
        .trusted.ToHost();
  }
  void ExpectOnlyThePlaneIsTrusted(const RefineOptions& options) {
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
  Camera camera_;
  Plane plane_;
  Image<float> depth_;
  Image<uint8_t> outliers_;
};

TEST_F(CorrelationTest, OutliersLoseTheTrustThatThePlaneKeeps) {
  ExpectOnlyThePlaneIsTrusted({});
}

TEST_F(CorrelationTest, PlanesOrTheMedianAloneTellOutliersToo) {
  RefineOptions median;
  median.superpixel_planes = false;
  ExpectOnlyThePlaneIsTrusted(median);
  RefineOptions planes;
  planes.weighted_median = false;
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

}  // namespace
}  // namespace tsar
