// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/normal_colors.h"

#include <limits>

#include <gtest/gtest.h>

namespace tsar {
namespace {

Rgb ColorOf(const Vec3f& normal) {
  return ColorizeNormals(Image<Vec3f>(1, 1, normal))(0, 0);
}

void ExpectColor(const Vec3f& normal, const Rgb& expected) {
  const Rgb color = ColorOf(normal);
  EXPECT_EQ(color.r, expected.r);
  EXPECT_EQ(color.g, expected.g);
  EXPECT_EQ(color.b, expected.b);
}

TEST(ColorizeNormals, TellsDirectionsAsTheViewerSeesThem) {
  ExpectColor({1.f, 0.f, 0.f}, {255, 128, 128});   // Right.
  ExpectColor({0.f, -1.f, 0.f}, {128, 255, 128});  // Up.
  ExpectColor({0.f, 0.f, -1.f}, {128, 128, 255});  // To the camera.
  ExpectColor({-0.6f, 0.f, -0.8f}, {51, 128, 230});
}

TEST(ColorizeNormals, NoNormalIsBlack) {
  ExpectColor({}, {0, 0, 0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  ExpectColor({nan, 0.f, 1.f}, {0, 0, 0});
}

TEST(ColorizeNormals, BoundsWhatIsTooLong) {
  ExpectColor({9.f, 9.f, -9.f}, {255, 0, 255});
}

TEST(ColorizeNormals, KeepsTheSize) {
  const Image<Rgb> colors = ColorizeNormals(Image<Vec3f>(3, 2));
  EXPECT_EQ(colors.Width(), 3);
  EXPECT_EQ(colors.Height(), 2);
  EXPECT_TRUE(ColorizeNormals({}).Empty());
}

}  // namespace
}  // namespace tsar
