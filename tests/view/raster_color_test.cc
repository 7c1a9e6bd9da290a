// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <algorithm>
#include <cstdlib>

#include "tests/support/test_device.h"
#include "tests/view/denoise/drawn_noise.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr double kLevel = 128.0;
constexpr ReducedRaster kRaster = {100, 60};

Image<Rgb> DrawNoisyWall() {
  NormalNoise noise(1);
  Image<Rgb> color(2 * kRaster.width, 2 * kRaster.height);
  for (Rgb& pixel : color) {
    pixel = GrayPixel(kLevel + 8.0 * noise.Next());
  }
  return color;
}

int LargestError(const Image<Rgb>& color) {
  int largest = 0;
  for (const Rgb& pixel : color) {
    largest = std::max(largest, std::abs(pixel.g - static_cast<int>(kLevel)));
  }
  return largest;
}

TEST(MakeRasterColor, TakesTheNoiseOut) {
  const auto device = CreateTestDevice(2);
  const Image<Rgb> wall = DrawNoisyWall();
  const Image<Rgb> reduced =
      MakeRasterColor(DeviceCopies(*device)(wall), kRaster, false, *device)
          .ToHost();
  const Image<Rgb> denoised =
      MakeRasterColor(DeviceCopies(*device)(wall), kRaster, true, *device)
          .ToHost();
  ASSERT_EQ(denoised.Width(), kRaster.width);
  ASSERT_EQ(denoised.Height(), kRaster.height);
  EXPECT_GT(LargestError(reduced), 10);
  EXPECT_LE(LargestError(denoised), 5);
}

}  // namespace
}  // namespace tsar
