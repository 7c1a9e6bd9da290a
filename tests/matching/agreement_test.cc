// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/agreement.h"

#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class AgreementTest : public testing::TestWithParam<float> {
 protected:
  AgreementTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(64, 48, 80.0)),
        scene_(DrawnPlane({0.3f, -0.2f, -1.f}, 3.f * GetParam()),
               camera_,
               *device_) {}

  void AddSource(double x, double angle) {
    scene_.AddSource(SourceCamera(
        camera_, GetParam() * Eigen::Vector3d(x, 0.05, 0.0), angle));
  }
  Image<uint8_t> Count() {
    return CountAgreeingSources(scene_.Reference(), scene_.Sources(), *device_)
        .ToHost();
  }
  // The pixels in the middle, which all sources see.
  void ExpectInTheMiddle(const Image<uint8_t>& counts, int expected) {
    ForEachPixel(22, 42, 12, 36, [&](int x, int y) {
      ASSERT_EQ(counts(x, y), expected) << x << ", " << y;
    });
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  TexturedPlane scene_;
};

TEST_P(AgreementTest, CountsTheSourcesThatSeeTheSameSurface) {
  AddSource(0.3, 0.08);
  AddSource(-0.3, -0.08);
  AddSource(0.2, 0.0);
  ExpectInTheMiddle(Count(), 3);
}

TEST_P(AgreementTest, LeavesOutDepthsThatDifferByTwoPercent) {
  AddSource(0.3, 0.08);
  AddSource(-0.3, -0.08);
  for (float& depth : scene_.SourceDepth(1)) {
    depth *= 1.02f;
  }
  ExpectInTheMiddle(Count(), 1);
  for (float& depth : scene_.Depth()) {
    depth *= 0.98f;
  }
  ExpectInTheMiddle(Count(), 0);
}

TEST_P(AgreementTest, IgnoresSourcesThatLookAwayOrHaveNoDepth) {
  AddSource(0.3, 3.14159265);
  AddSource(0.2, 0.0);
  scene_.SourceDepth(1) = Image<float>(64, 48, 0.f);
  ExpectInTheMiddle(Count(), 0);
  // A source may also come without a depth map.
  scene_.SourceDepth(1) = Image<float>();
  ExpectInTheMiddle(Count(), 0);
}

TEST_P(AgreementTest, SaturatesAt255) {
  for (int i = 0; i < 260; ++i) {
    AddSource(0.2, 0.0);
  }
  EXPECT_EQ(Count()(30, 20), 255);
}

INSTANTIATE_TEST_SUITE_P(Scales,
                         AgreementTest,
                         testing::Values(1e-3f, 1.f, 1e3f));

}  // namespace
}  // namespace tsar
