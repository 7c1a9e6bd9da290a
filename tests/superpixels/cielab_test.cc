// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/superpixels/cielab.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

Vec3f Convert(const Rgb& color) {
  const auto device = Device::CreateCpu(1);
  return ConvertToLab(Image<Rgb>(1, 1, color).View(), *device).ToHost()(0, 0);
}

void ExpectLab(const Rgb& color, float l, float a, float b) {
  const Vec3f lab = Convert(color);
  EXPECT_NEAR(lab.x, l, 0.02f);
  EXPECT_NEAR(lab.y, a, 0.02f);
  EXPECT_NEAR(lab.z, b, 0.02f);
}

TEST(ConvertToLab, KnowsTheColorsOfTheTables) {
  ExpectLab({0, 0, 0}, 0.f, 0.f, 0.f);
  ExpectLab({255, 255, 255}, 100.f, 0.f, 0.f);
  ExpectLab({128, 128, 128}, 53.59f, 0.f, 0.f);
  ExpectLab({255, 0, 0}, 53.24f, 80.09f, 67.20f);
  ExpectLab({0, 255, 0}, 87.74f, -86.18f, 83.18f);
  ExpectLab({0, 0, 255}, 32.30f, 79.20f, -107.86f);
}

// OpenCV interpolates in a table, which is coarser than arithmetic.
TEST(ConvertToLab, IsCloseToThatOfOpenCv) {
  // Every fifth level of each channel, so that 0 and 255 are among them.
  constexpr int kStep = 5;
  constexpr int kNumLevels = 255 / kStep + 1;
  Image<Rgb> color(kNumLevels * kNumLevels, kNumLevels);
  for (int y = 0; y < color.Height(); ++y) {
    for (int x = 0; x < color.Width(); ++x) {
      color(x, y) = {static_cast<uint8_t>(x % kNumLevels * kStep),
                     static_cast<uint8_t>(x / kNumLevels * kStep),
                     static_cast<uint8_t>(y * kStep)};
    }
  }
  const auto device = Device::CreateCpu(2);
  const Image<Vec3f> lab = ConvertToLab(color.View(), *device).ToHost();
  const cv::Mat rgb(color.Height(), color.Width(), CV_8UC3, color.Data());
  cv::Mat expected;
  rgb.convertTo(expected, CV_32FC3, 1.0 / 255.0);
  cv::cvtColor(expected, expected, cv::COLOR_RGB2Lab);
  for (int y = 0; y < color.Height(); ++y) {
    for (int x = 0; x < color.Width(); ++x) {
      const cv::Vec3f& other = expected.at<cv::Vec3f>(y, x);
      ASSERT_NEAR(lab(x, y).x, other[0], 0.5f) << x << ", " << y;
      ASSERT_NEAR(lab(x, y).y, other[1], 0.5f) << x << ", " << y;
      ASSERT_NEAR(lab(x, y).z, other[2], 0.5f) << x << ", " << y;
    }
  }
}

}  // namespace
}  // namespace tsar
