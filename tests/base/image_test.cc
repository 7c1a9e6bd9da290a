// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/image.h"

#include "colmap_tsar/base/vector.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Image, HoldsItsValueEverywhere) {
  for (const auto& [width, height] :
       {std::pair(0, 0), std::pair(1, 70000), std::pair(1500, 1400)}) {
    const Vec3f normal = {1.f, 2.f, 3.f};
    for (const Vec3f& value : {Vec3f(), normal}) {
      const Image<Vec3f> image(width, height, value);
      ASSERT_EQ(image.NumPixels(), static_cast<size_t>(width) * height);
      EXPECT_TRUE(std::all_of(image.begin(), image.end(), [&](const Vec3f& n) {
        return n == value;
      }));
    }
    Image<Vec3f> image = Image<Vec3f>::Uninitialized(width, height);
    EXPECT_EQ(image.Width(), width);
    EXPECT_EQ(image.Height(), height);
    std::fill(image.begin(), image.end(), normal);
    const Image<Vec3f> copy = image;
    image = {};
    EXPECT_TRUE(image.Empty());
    EXPECT_EQ(std::count(copy.begin(), copy.end(), normal),
              static_cast<std::ptrdiff_t>(copy.NumPixels()));
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
