// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

// Of 4 x 2 pixels: one superpixel of two, one of six, one of none.
ViewEvidence DrawnEvidence() {
  ViewEvidence evidence;
  evidence.width = 4;
  evidence.height = 2;
  evidence.superpixels = Image<uint16_t>(4, 2, uint16_t{1});
  evidence.superpixels(0, 0) = 0;
  evidence.superpixels(0, 1) = 0;
  evidence.weights.resize(3);
  return evidence;
}

TEST(SuperpixelRays, CountsPixels) {
  EXPECT_EQ(CountPixels(DrawnEvidence()), (std::vector<float>{2.f, 6.f, 0.f}));
}

TEST(SuperpixelRays, PassThroughTheMiddle) {
  const Intrinsics intrinsics = {2.f, 4.f, 1.f, 0.5f};
  const std::vector<Vec3f> rays = MiddleRays(DrawnEvidence(), intrinsics);
  ASSERT_EQ(rays.size(), 3u);
  EXPECT_EQ(rays[0].x, -0.5f);
  EXPECT_EQ(rays[0].y, 0.f);
  EXPECT_EQ(rays[0].z, 1.f);
  EXPECT_EQ(rays[1].x, 0.5f);
  EXPECT_EQ(rays[1].y, 0.f);
}

}  // namespace
}  // namespace tsar
