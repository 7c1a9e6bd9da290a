// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/superpixels/reduce_color.h"

#include "colmap_tsar/base/random.h"

#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

Image<Rgb> DrawNoise(int width, int height) {
  Image<Rgb> color(width, height);
  Philox random(11, 0, 0);
  for (Rgb& pixel : color) {
    pixel = {static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256))};
  }
  return color;
}

Image<Rgb> Reduce(const Image<Rgb>& color, int width, int height) {
  const auto device = Device::CreateCpu(2);
  return ReduceColor(color.View(), {width, height}, *device).ToHost();
}

bool operator==(const Rgb& a, const Rgb& b) {
  return a.r == b.r && a.g == b.g && a.b == b.b;
}

TEST(ReduceColor, TakesTheRoundedMean) {
  Image<Rgb> color(4, 2, {0, 0, 0});
  color(0, 0) = {255, 1, 4};
  color(1, 1) = {255, 0, 4};
  // The means are 127.5, 0.25 and 2.
  const Image<Rgb> reduced = Reduce(color, 2, 1);
  EXPECT_TRUE(reduced(0, 0) == (Rgb{128, 0, 2}));
  EXPECT_TRUE(reduced(1, 0) == (Rgb{0, 0, 0}));
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

TEST(ReduceColor, LeavesAnImageOfTheSameSizeAsItIs) {
  const Image<Rgb> color = DrawNoise(37, 13);
  const Image<Rgb> reduced = Reduce(color, 37, 13);
  for (size_t i = 0; i < color.NumPixels(); ++i) {
    ASSERT_TRUE(reduced.Data()[i] == color.Data()[i]);
  }
}

TEST(ReduceColor, IsThatOfOpenCv) {
  const std::vector<std::pair<cv::Size, cv::Size>> sizes = {
      {{200, 100}, {50, 25}},
      {{131, 97}, {77, 57}},
      {{97, 1}, {31, 1}},
      {{1, 97}, {1, 31}},
      {{65539, 3}, {777, 1}}};
  for (const auto& [full, size] : sizes) {
    const Image<Rgb> color = DrawNoise(full.width, full.height);
    const Image<Rgb> reduced = Reduce(color, size.width, size.height);
    const cv::Mat source(full, CV_8UC3, const_cast<Rgb*>(color.Data()));
    cv::Mat expected;
    cv::resize(source, expected, size, 0, 0, cv::INTER_AREA);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        const cv::Vec3b& other = expected.at<cv::Vec3b>(y, x);
        ASSERT_LE(std::abs(reduced(x, y).r - other[0]), 1) << full << x;
        ASSERT_LE(std::abs(reduced(x, y).g - other[1]), 1) << full << x;
        ASSERT_LE(std::abs(reduced(x, y).b - other[2]), 1) << full << x;
      }
    }
  }
}

}  // namespace
}  // namespace tsar
