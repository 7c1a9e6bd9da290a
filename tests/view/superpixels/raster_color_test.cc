// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/cielab.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <cstdlib>
#include <utility>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include "tests/view/denoise/drawn_noise.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

// OpenCV interpolates in a table, which is coarser than arithmetic.
TEST(ConvertToLab, IsCloseToThatOfOpenCv) {
  // Every fifth level of each channel, so that 0 and 255 are among them.
  constexpr int kStep = 5;
  constexpr int kNumLevels = 255 / kStep + 1;
  Image<Rgb> color(kNumLevels * kNumLevels, kNumLevels);
  ForEachPixel(color.Width(), color.Height(), [&](int x, int y) {
    color(x, y) = {static_cast<uint8_t>(x % kNumLevels * kStep),
                   static_cast<uint8_t>(x / kNumLevels * kStep),
                   static_cast<uint8_t>(y * kStep)};
  });
  const auto device = CreateTestDevice(2);
  const Image<Vec3f> lab =
      ConvertToLab(DeviceCopies(*device)(color), *device).ToHost();
  const cv::Mat rgb(color.Height(), color.Width(), CV_8UC3, color.Data());
  cv::Mat expected;
  rgb.convertTo(expected, CV_32FC3, 1.0 / 255.0);
  cv::cvtColor(expected, expected, cv::COLOR_RGB2Lab);
  ForEachPixel(color.Width(), color.Height(), [&](int x, int y) {
    const cv::Vec3f& other = expected.at<cv::Vec3f>(y, x);
    ASSERT_NEAR(lab(x, y).x, other[0], 0.5f) << x << ", " << y;
    ASSERT_NEAR(lab(x, y).y, other[1], 0.5f) << x << ", " << y;
    ASSERT_NEAR(lab(x, y).z, other[2], 0.5f) << x << ", " << y;
  });
}

Image<Rgb> Reduce(const Image<Rgb>& color, int width, int height) {
  const auto device = CreateTestDevice(2);
  DeviceCopies on_device(*device);
  return ReduceColor(on_device(color), {width, height}, *device).ToHost();
}

TEST(ReduceColor, CountsPixelsByTheAreaThatIsCovered) {
  // Two of three: the middle pixel counts half on both sides.
  Image<Rgb> color(3, 1);
  color(0, 0) = {30, 0, 0};
  color(1, 0) = {60, 0, 0};
  color(2, 0) = {120, 0, 0};
  const Image<Rgb> reduced = Reduce(color, 2, 1);
  EXPECT_EQ(reduced(0, 0).r, 40);
  EXPECT_EQ(reduced(1, 0).r, 100);
}

TEST(ReduceColor, IsThatOfOpenCv) {
  const std::vector<std::pair<cv::Size, cv::Size>> sizes = {
      {{200, 100}, {50, 25}},
      {{131, 97}, {77, 57}},
      {{97, 1}, {31, 1}},
      {{1, 97}, {1, 31}},
      {{65539, 3}, {777, 1}}};
  for (const auto& [full, size] : sizes) {
    const Image<Rgb> color = DrawColors(full.width, full.height, 7);
    const Image<Rgb> reduced = Reduce(color, size.width, size.height);
    const cv::Mat source(full, CV_8UC3, const_cast<Rgb*>(color.Data()));
    cv::Mat expected;
    cv::resize(source, expected, size, 0, 0, cv::INTER_AREA);
    ForEachPixel(size.width, size.height, [&](int x, int y) {
      const cv::Vec3b& other = expected.at<cv::Vec3b>(y, x);
      ASSERT_LE(std::abs(reduced(x, y).r - other[0]), 1) << full << x;
      ASSERT_LE(std::abs(reduced(x, y).g - other[1]), 1) << full << x;
      ASSERT_LE(std::abs(reduced(x, y).b - other[2]), 1) << full << x;
    });
  }
}

}  // namespace
}  // namespace tsar
