// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_pixel.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(FusionPixelTest, NormalsOfAllDirectionsComeBack) {
  for (int i = 0; i < 400; ++i) {
    const double z = -1.0 + 2.0 * (i + 0.5) / 400;
    const double angle = 2.4 * i;
    const double radius = std::sqrt(1.0 - z * z);
    const Vec3f normal = {static_cast<float>(radius * std::cos(angle)),
                          static_cast<float>(radius * std::sin(angle)),
                          static_cast<float>(z)};
    FusionPixel pixel;
    EncodeNormal(normal, &pixel);
    EXPECT_LT(Norm(DecodeNormal(pixel) - normal), 1e-4f) << i;
  }
}

TEST(FusionPixelTest, AxesComeBackExactly) {
  for (const Vec3f& axis : {Vec3f{1.f, 0.f, 0.f},
                            Vec3f{0.f, -1.f, 0.f},
                            Vec3f{0.f, 0.f, 1.f},
                            Vec3f{0.f, 0.f, -1.f}}) {
    FusionPixel pixel;
    EncodeNormal(axis, &pixel);
    const Vec3f decoded = DecodeNormal(pixel);
    EXPECT_EQ(decoded.x, axis.x);
    EXPECT_EQ(decoded.y, axis.y);
    EXPECT_EQ(decoded.z, axis.z);
  }
}

TEST(FusionPixelTest, AnUnknownNormalStaysUnknown) {
  FusionPixel pixel;
  EXPECT_EQ(DecodeNormal(pixel), Vec3f());
  EncodeNormal({1.f, 0.f, 0.f}, &pixel);
  EncodeNormal({}, &pixel);
  EXPECT_EQ(DecodeNormal(pixel), Vec3f());
}

TEST(FusionPixelTest, SigmaKeepsItsValueWithinAStepAndIsNeverZero) {
  for (const float sigma : {1e-5f, 1e-3f, 0.01f, 0.2f}) {
    EXPECT_NEAR(
        static_cast<float>(EncodeSigma(sigma)) * kSigmaStep, sigma, kSigmaStep);
  }
  EXPECT_EQ(EncodeSigma(0.f), 1);
  EXPECT_EQ(EncodeSigma(1e9f), 65535);
}

}  // namespace
}  // namespace tsar
