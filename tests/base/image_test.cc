// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/image.h"

#include "colmap_tsar/base/vector.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// Below and above the size from which on huge pages are asked for.
constexpr int kSizes[][2] = {
    {0, 0}, {1, 1}, {1, 70000}, {641, 479}, {1500, 1400}};

TEST(Image, HoldsItsValueEverywhere) {
  for (const auto& [width, height] : kSizes) {
    const Image<float> zeros(width, height);
    EXPECT_EQ(zeros.NumPixels(), static_cast<size_t>(width) * height);
    EXPECT_TRUE(std::all_of(
        zeros.begin(), zeros.end(), [](float z) { return z == 0.f; }));
    const Vec3f normal = {1.f, 2.f, 3.f};
    const Image<Vec3f> normals(width, height, normal);
    EXPECT_TRUE(std::all_of(normals.begin(),
                            normals.end(),
                            [&](const Vec3f& n) { return n == normal; }));
    const Image<Vec3f> zero_normals(width, height);
    EXPECT_TRUE(std::all_of(zero_normals.begin(),
                            zero_normals.end(),
                            [](const Vec3f& n) { return n == Vec3f(); }));
  }
}

TEST(Image, WithoutValuesHasItsSize) {
  for (const auto& [width, height] : kSizes) {
    Image<Vec3f> image = Image<Vec3f>::Uninitialized(width, height);
    EXPECT_EQ(image.Width(), width);
    EXPECT_EQ(image.Height(), height);
    ASSERT_EQ(image.NumPixels(), static_cast<size_t>(width) * height);
    // All of it can be written.
    std::fill(image.begin(), image.end(), Vec3f{1.f, 2.f, 3.f});
    const Image<Vec3f> copy = image;
    image = {};
    EXPECT_EQ(image.NumPixels(), 0u);
    EXPECT_TRUE(std::all_of(copy.begin(), copy.end(), [](const Vec3f& n) {
      return n == Vec3f{1.f, 2.f, 3.f};
    }));
  }
}

TEST(GrayLevel, WeighsColorsAndKeepsGrays) {
  EXPECT_FLOAT_EQ(GrayLevel({10, 20, 30}),
                  0.299f * 10 + 0.587f * 20 + 0.114f * 30);
  for (const uint8_t level : {0, 1, 128, 255}) {
    EXPECT_FLOAT_EQ(GrayLevel({level, level, level}), level);
  }
}

}  // namespace
}  // namespace tsar
