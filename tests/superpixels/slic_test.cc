// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/superpixels/slic.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/superpixels/segment_checks.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

Superpixels Compute(const Image<Rgb>& color,
                    int superpixel_size,
                    Device& device) {
  const Image<float> score(color.Width(), color.Height(), 1.f);
  SlicOptions options;
  options.superpixel_size = superpixel_size;
  return ComputeSuperpixels(DeviceImage<Rgb>(device, color).View(),
                            DeviceImage<float>(device, score).View(),
                            options,
                            device);
}

Image<Rgb> DrawNoise(int width, int height) {
  Image<Rgb> color(width, height);
  Philox random(7, 0, 0);
  for (Rgb& pixel : color) {
    pixel = {static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256)),
             static_cast<uint8_t>(random.NextBelow(256))};
  }
  return color;
}

TEST(Superpixels, AreConnectedAndLargeEnough) {
  const auto device = Device::CreateCpu(1);
  const std::vector<std::pair<int, int>> image_sizes = {
      {120, 90}, {97, 61}, {200, 20}};
  for (const auto& [width, height] : image_sizes) {
    for (const Image<Rgb>& color :
         {Image<Rgb>(width, height, {90, 90, 90}), DrawNoise(width, height)}) {
      const Superpixels superpixels = Compute(color, 100, *device);
      const std::vector<int> sizes =
          CheckSegments(superpixels.labels.ToHost(), superpixels.count);
      EXPECT_GE(*std::min_element(sizes.begin(), sizes.end()), 25);
    }
  }
}

TEST(Superpixels, OfAPlainImageHaveTheSizeAskedFor) {
  const auto device = Device::CreateCpu(1);
  const Superpixels superpixels =
      Compute(Image<Rgb>(120, 100, {90, 90, 90}), 100, *device);
  EXPECT_NEAR(superpixels.count, 120, 12);
}

TEST(Superpixels, DoNotCrossAColorEdge) {
  const auto device = Device::CreateCpu(1);
  // The edge lies at every offset to the grid of clusters, straight or slanted.
  for (const double slope : {0.0, 0.4}) {
    for (int offset = 60; offset < 80; offset += 3) {
      Image<Rgb> color(140, 60, {20, 40, 60});
      for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 140; ++x) {
          if (x >= offset + slope * (y - 30)) {
            color(x, y) = {220, 200, 180};
          }
        }
      }
      const Superpixels superpixels = Compute(color, 400, *device);
      const Image<int> labels = superpixels.labels.ToHost();
      CheckSegments(labels, superpixels.count);
      std::vector<int> bright(superpixels.count, -1);
      for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 140; ++x) {
          int& side = bright[labels(x, y)];
          const int here = color(x, y).r > 100 ? 1 : 0;
          ASSERT_TRUE(side < 0 || side == here)
              << offset << ": " << x << ", " << y;
          side = here;
        }
      }
    }
  }
}

TEST(Superpixels, DoNotDependOnTheNumberOfThreads) {
  const Image<Rgb> color = DrawNoise(131, 97);
  const auto one = Device::CreateCpu(1);
  const Superpixels expected = Compute(color, 150, *one);
  const Image<int> expected_labels = expected.labels.ToHost();
  for (const int num_threads : {1, 2, 7}) {
    const auto device = Device::CreateCpu(num_threads);
    const Superpixels superpixels = Compute(color, 150, *device);
    EXPECT_EQ(superpixels.count, expected.count);
    const Image<int> labels = superpixels.labels.ToHost();
    EXPECT_TRUE(
        std::equal(labels.begin(), labels.end(), expected_labels.begin()));
  }
}

TEST(Superpixels, OfATinyImageAreOne) {
  const auto device = Device::CreateCpu(2);
  const std::vector<std::pair<int, int>> image_sizes = {
      {1, 1}, {2, 3}, {9, 1}, {1, 9}};
  for (const auto& [width, height] : image_sizes) {
    const Superpixels superpixels =
        Compute(DrawNoise(width, height), 400, *device);
    EXPECT_EQ(superpixels.count, 1);
    CheckSegments(superpixels.labels.ToHost(), 1);
  }
}

// A badly matched cluster costs less, so it takes pixels from its neighbours.
TEST(Superpixels, BadlyMatchedOnesAttractPixels) {
  const auto device = Device::CreateCpu(1);
  const Image<Rgb> color(100, 40, {90, 90, 90});
  Image<float> score(100, 40, 0.2f);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) {
      score(x, y) = 1.5f;
    }
  }
  const Superpixels superpixels =
      ComputeSuperpixels(color.View(), score.View(), {}, *device);
  const Image<int> labels = superpixels.labels.ToHost();
  CheckSegments(labels, superpixels.count);
  // With equal scores the border lies in the middle, between columns 49 and 50.
  int moved = 0;
  for (int y = 0; y < 40; ++y) {
    moved += labels(49, y) == labels(53, y) ? 1 : 0;
  }
  EXPECT_GT(moved, 30);
}

}  // namespace
}  // namespace tsar
