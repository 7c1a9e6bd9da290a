// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Drawn views to be refined, and what must hold for the maps.

#include "colmap_tsar/compose/refine_image.h"

#include <cmath>
#include <memory>

#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {

class SyntheticViewsTest : public testing::Test {
 protected:
  SyntheticViewsTest()
      : device_(CreateTestDevice(2)), drawn_(MakeSyntheticViews({})) {}

  float RelativeError(const Image<float>& depth, int x, int y) const {
    return std::abs(depth(x, y) / drawn_.truth(x, y) - 1.f);
  }
  // Of the first view, which is the reference.
  const Image<float>& Before() const { return drawn_.views[0].depth; }
  bool IsBare(int x, int y) const {
    return SyntheticViews::IsBare(
        drawn_.views[0].camera.GetIntrinsics().Ray(x, y));
  }
  // What holds for the maps whatever the options.
  void ExpectSoundMaps(const RefinedMaps& maps) const {
    ASSERT_TRUE(maps.depth.HasSizeOf(Before()));
    const Intrinsics intrinsics = drawn_.views[0].camera.GetIntrinsics();
    for (int y = 0; y < maps.depth.Height(); ++y) {
      for (int x = 0; x < maps.depth.Width(); ++x) {
        const float depth = maps.depth(x, y);
        const Vec3f& normal = maps.normal(x, y);
        const float confidence = maps.confidence(x, y);
        ASSERT_TRUE(std::isfinite(depth) && depth >= 0.f) << x << ", " << y;
        ASSERT_TRUE(confidence >= 0.f && confidence <= 1.f) << x << ", " << y;
        ASSERT_EQ(confidence > 0.f, depth > 0.f) << x << ", " << y;
        ASSERT_EQ(maps.provenance(x, y) != 0, depth > 0.f) << x << ", " << y;
        if (depth > 0.f) {
          ASSERT_NEAR(Norm(normal), 1.f, 1e-4f) << x << ", " << y;
          ASSERT_LT(Dot(normal, intrinsics.Ray(x, y)), 0.f) << x << ", " << y;
        } else {
          ASSERT_EQ(normal, Vec3f{}) << x << ", " << y;
        }
      }
    }
  }
  // scale: of the depths of b, relative to those of a.
  static void ExpectSameMaps(const RefinedMaps& a,
                             const RefinedMaps& b,
                             float scale = 1.f) {
    for (size_t i = 0; i < a.depth.NumPixels(); ++i) {
      ASSERT_EQ(a.depth.Data()[i] * scale, b.depth.Data()[i]) << i;
      ASSERT_EQ(a.normal.Data()[i], b.normal.Data()[i]) << i;
      ASSERT_EQ(a.confidence.Data()[i], b.confidence.Data()[i]) << i;
      ASSERT_EQ(a.provenance.Data()[i], b.provenance.Data()[i]) << i;
    }
  }

  std::unique_ptr<Device> device_;
  SyntheticViews drawn_;
};

}  // namespace tsar
