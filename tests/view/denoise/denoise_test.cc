// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/denoise/denoise.h"

#include "colmap_tsar/view/denoise/denoise_kernels.cuh"

#include <cmath>
#include <cstdlib>
#include <utility>

#include "tests/support/for_each_pixel.h"
#include "tests/support/same_bytes.h"
#include "tests/support/test_device.h"
#include "tests/view/denoise/drawn_noise.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

Image<Rgb> DenoiseOnCpu(const Image<Rgb>& color,
                        const Image<float>& gray,
                        const NoiseCurve& noise,
                        int num_threads) {
  const auto device = CreateTestDevice(num_threads);
  DeviceCopies on_device(*device);
  return Denoise(on_device(color), on_device(gray), noise, *device).ToHost();
}

// color: gray pixels.
Image<float> DenoiseGray(const Image<Rgb>& color, double sigma) {
  const NoiseCurve noise{static_cast<float>(sigma * sigma), 0.f};
  return ToGray(DenoiseOnCpu(color, ToGray(color), noise, 2));
}

// Root of the mean squared difference from a level, in these columns.
double Deviation(const Image<float>& gray, double level, int from, int to) {
  double squares = 0.0;
  ForEachPixel(from, to, 0, gray.Height(), [&](int x, int y) {
    squares += std::pow(gray(x, y) - level, 2);
  });
  return std::sqrt(squares / (gray.Height() * (to - from)));
}

double ColumnMean(const Image<float>& gray, int x) {
  double sum = 0.0;
  for (int y = 0; y < gray.Height(); ++y) {
    sum += gray(x, y);
  }
  return sum / gray.Height();
}

TEST(Denoise, LeavesLessThanAThirdOfTheNoise) {
  for (const double sigma : {2.0, 4.0, 8.0}) {
    NormalNoise noise(4);
    Image<Rgb> color(90, 70);
    for (Rgb& pixel : color) {
      pixel = GrayPixel(128.0 + sigma * noise.Next());
    }
    const Image<float> denoised = DenoiseGray(color, sigma);
    EXPECT_LT(Deviation(denoised, 128.0, 0, 90), sigma / 3.0);
    // Along the border, too.
    EXPECT_LT(Deviation(denoised, 128.0, 0, 1), sigma / 2.0);
    EXPECT_LT(Deviation(denoised, 128.0, 89, 90), sigma / 2.0);
  }
}

TEST(Denoise, KeepsAStepInPlace) {
  constexpr double kSigma = 4.0;
  constexpr double kStep = 5.0 * kSigma;
  constexpr int kMiddle = 40;
  NormalNoise noise(5);
  Image<Rgb> color(80, 200);
  ForEachPixel(color.Width(), color.Height(), [&](int x, int y) {
    color(x, y) = GrayPixel((x < kMiddle ? 100.0 : 100.0 + kStep) +
                            kSigma * noise.Next());
  });
  const Image<float> denoised = DenoiseGray(color, kSigma);
  const double left = ColumnMean(denoised, kMiddle - 2);
  const double right = ColumnMean(denoised, kMiddle + 1);
  EXPECT_GT(right - left, 0.9 * kStep);
  EXPECT_NEAR(left, 100.0, 0.1 * kStep);
  EXPECT_NEAR(right, 100.0 + kStep, 0.1 * kStep);
  // The largest difference between columns is still there.
  EXPECT_GT(ColumnMean(denoised, kMiddle) - ColumnMean(denoised, kMiddle - 1),
            0.5 * kStep);
}

TEST(Denoise, LeavesTextureWithoutNoiseAsItIs) {
  const Image<Rgb> color = DrawColors(70, 50, 6);
  const Image<Rgb> denoised =
      DenoiseOnCpu(color, ToGray(color), {1.f / 12.f, 0.f}, 2);
  for (size_t i = 0; i < color.NumPixels(); ++i) {
    const Rgb& before = color.Data()[i];
    const Rgb& after = denoised.Data()[i];
    ASSERT_LE(std::abs(before.r - after.r), 1);
    ASSERT_LE(std::abs(before.g - after.g), 1);
    ASSERT_LE(std::abs(before.b - after.b), 1);
  }
}

TEST(Denoise, BothFormsGiveTheSameBitsOnAnyNumberOfThreads) {
  for (const auto& [width, height] : {std::pair(1, 1),
                                      std::pair(3, 2),
                                      std::pair(1, 40),
                                      std::pair(40, 1),
                                      std::pair(67, 35)}) {
    Philox random(static_cast<uint32_t>(width), 1, 0);
    Image<Rgb> color(width, height);
    Image<float> gray(width, height);
    for (size_t i = 0; i < color.NumPixels(); ++i) {
      const auto draw = [&] {
        return static_cast<uint8_t>(110 + random.NextBelow(40));
      };
      const Rgb rgb = {draw(), draw(), draw()};
      color.Data()[i] = rgb;
      gray.Data()[i] =
          0.3f * static_cast<float>(rgb.r) + 0.7f * static_cast<float>(rgb.g);
    }
    const NoiseCurve noise{8.f, 0.1f};
    SCOPED_TRACE(testing::Message() << width << " x " << height);
    Image<Rgb> by_pixel(width, height);
    const DenoisePixelKernel kernel{
        {color.View(), gray.View(), noise, by_pixel.View()}};
    ForEachPixel(width, height, [&](int x, int y) { kernel(x, y); });
    for (const int num_threads : {1, 3}) {
      const Image<Rgb> by_band = DenoiseOnCpu(color, gray, noise, num_threads);
      EXPECT_TRUE(SameBytes(by_pixel, by_band));
    }
  }
}

}  // namespace
}  // namespace tsar
