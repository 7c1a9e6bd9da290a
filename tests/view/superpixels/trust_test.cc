// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/trust.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/buffer.h"

#include <cmath>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 47;

TEST(InverseDepthPlane, IsThePlaneThatItWasMadeOf) {
  const Plane plane = DrawnPlane({0.4f, -0.3f, -1.f}, 4.f);
  const Vec3f ray = {0.3f, -0.2f, 1.f};
  const Vec3f other = {-0.5f, 0.1f, 1.f};
  const float depth = plane.Depth(ray);
  for (const InverseDepthPlane& q :
       {ToInverseDepth(plane), ToInverseDepth(ray, depth, plane.normal)}) {
    EXPECT_NEAR(Dot(q, ray) * depth, 1.f, 1e-5f);
    EXPECT_NEAR(Dot(q, other) * plane.Depth(other), 1.f, 1e-5f);
  }
}

// A slanted plane under noise, with holes.
class TrustTest : public testing::Test {
 protected:
  TrustTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 50.0)),
        plane_(DrawnPlane({0.5f, -0.2f, -1.f}, 4.f)),
        depth_(DrawDepth(plane_, camera_)),
        normal_(kWidth, kHeight, plane_.normal),
        score_(kWidth, kHeight),
        color_(kWidth, kHeight),
        trusted_(kWidth, kHeight, 1) {
    Camera source = camera_;
    source.translation.x() = 0.4;
    scale_ = ComputeDisparityScale(camera_, {source});
    Philox random(7, 0, 0);
    for (size_t i = 0; i < depth_.NumPixels(); ++i) {
      depth_.Data()[i] *= 0.8f + 0.4f * random.NextFloat();
      if (random.NextBelow(5) == 0) {
        depth_.Data()[i] = 0.f;
        normal_.Data()[i] = {};
      }
      score_.Data()[i] = 0.2f + random.NextFloat();
      color_.Data()[i].g = static_cast<uint8_t>(random.NextBelow(40));
      trusted_.Data()[i] = random.NextBelow(4) == 0 ? 0 : 1;
    }
  }

  TrustGate Gate(float tolerance, bool readmit) {
    return {on_device_(score_), scale_, tolerance, readmit};
  }
  Image<uint8_t> Run(const Image<Plane>& planes,
                     const WeightedMedianOptions* filter,
                     const TrustGate& gate) {
    DeviceImage<uint8_t> trusted(*device_, trusted_);
    DeviceImage<InverseDepthPlane> estimate(*device_, kWidth, kHeight);
    GateRound({on_device_(depth_), on_device_(normal_)},
              {on_device_(planes), camera_.GetIntrinsics(), kWidth, kHeight},
              on_device_(color_),
              filter,
              gate,
              estimate.View(),
              trusted.View(),
              *device_);
    return trusted.ToHost();
  }
  // The gate as Eq. 9 states it, by an estimated depth.
  bool Passes(const TrustGate& gate, float estimate, int x, int y) const {
    const float own = depth_(x, y);
    return own > 0.f && estimate > 0.f &&
           (trusted_(x, y) != 0 || gate.readmit_filtered) &&
           std::abs(scale_.ToDisparity(estimate) - scale_.ToDisparity(own)) <
               gate.tolerance / score_(x, y);
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  Camera camera_;
  Plane plane_;
  Image<float> depth_;
  Image<Vec3f> normal_;
  Image<float> score_;
  Image<Rgb> color_;
  Image<uint8_t> trusted_;
  DisparityScale scale_;
};

TEST_F(TrustTest, TheMedianNeedNotBeKnownToTellWhoPasses) {
  for (const bool readmit : {false, true}) {
    for (const float radius : {5.f, 20.f}) {
      WeightedMedianOptions options;
      options.radius = radius;
      Image<float> estimate = depth_;
      for (size_t i = 0; i < estimate.NumPixels(); ++i) {
        estimate.Data()[i] *= trusted_.Data()[i];
      }
      const Image<float> median =
          WeightedMedianFilter({on_device_(estimate), on_device_(normal_)},
                               on_device_(color_),
                               {},
                               camera_.GetIntrinsics(),
                               options,
                               *device_)
              .depth.ToHost();
      // A tenth of the disparities: some pass, some do not.
      const TrustGate gate =
          Gate(0.1f * scale_.ToDisparity(plane_.offset), readmit);
      const Image<uint8_t> passed = Run({}, &options, gate);
      int num_passed = 0;
      int num_different = 0;
      ForEachPixel(kWidth, kHeight, [&](int x, int y) {
        num_passed += passed(x, y);
        num_different +=
            (passed(x, y) != 0) == Passes(gate, median(x, y), x, y) ? 0 : 1;
      });
      EXPECT_GT(num_passed, kWidth * kHeight / 5);
      EXPECT_LT(num_passed, kWidth * kHeight * 4 / 5);
      // Medians may round to the other side of the gate.
      EXPECT_LE(num_different, 2);
    }
  }
}

TEST_F(TrustTest, PlanesAreTakenAsTheyAre) {
  const TrustGate gate = Gate(0.05f * scale_.ToDisparity(plane_.offset), true);
  const Image<uint8_t> passed =
      Run(Image<Plane>(kWidth, kHeight, plane_), nullptr, gate);
  const Image<float> expected = DrawDepth(plane_, camera_);
  int num_passed = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    num_passed += passed(x, y);
    EXPECT_EQ(passed(x, y) != 0, Passes(gate, expected(x, y), x, y))
        << x << ", " << y;
  });
  EXPECT_GT(num_passed, kWidth * kHeight / 10);
  EXPECT_LT(num_passed, kWidth * kHeight * 4 / 5);
}

}  // namespace
}  // namespace tsar
