// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/slic.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include "tests/view/denoise/drawn_noise.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// Checks that labels are 0 ... count - 1, all of them used, and that the pixels
// of each are 4-connected. Returns the sizes of the segments.
std::vector<int> CheckSegments(const Image<int>& labels, int count) {
  std::vector<int> sizes(count, 0);
  std::vector<int> num_parts(count, 0);
  Image<char> seen(labels.Width(), labels.Height(), 0);
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      const int label = labels(x, y);
      if (label < 0 || label >= count) {
        ADD_FAILURE() << "label " << label << " at " << x << ", " << y;
        return sizes;
      }
      ++sizes[label];
      if (seen(x, y)) {
        continue;
      }
      ++num_parts[label];
      std::vector<std::pair<int, int>> front = {{x, y}};
      seen(x, y) = 1;
      while (!front.empty()) {
        const auto [column, row] = front.back();
        front.pop_back();
        for (const auto& [dx, dy] : {std::pair(1, 0),
                                     std::pair(-1, 0),
                                     std::pair(0, 1),
                                     std::pair(0, -1)}) {
          const int c = column + dx;
          const int r = row + dy;
          if (labels.Contains(c, r) && labels(c, r) == label && !seen(c, r)) {
            seen(c, r) = 1;
            front.push_back({c, r});
          }
        }
      }
    }
  }
  EXPECT_EQ(num_parts, std::vector<int>(count, 1));
  return sizes;
}

Superpixels Compute(const Image<Rgb>& color,
                    int superpixel_size,
                    Device& device) {
  const Image<float> score(color.Width(), color.Height(), 1.f);
  return ComputeSuperpixels(DeviceImage<Rgb>(device, color).View(),
                            DeviceImage<float>(device, score).View(),
                            superpixel_size,
                            device);
}

TEST(Superpixels, AreConnectedAndLargeEnough) {
  const auto device = CreateTestDevice(1);
  const std::vector<std::pair<int, int>> image_sizes = {
      {120, 90}, {97, 61}, {200, 20}};
  for (const auto& [width, height] : image_sizes) {
    for (const Image<Rgb>& color : {Image<Rgb>(width, height, {90, 90, 90}),
                                    DrawColors(width, height, 7)}) {
      const Superpixels superpixels = Compute(color, 100, *device);
      const std::vector<int> sizes =
          CheckSegments(superpixels.labels.ToHost(), superpixels.count);
      EXPECT_GE(*std::min_element(sizes.begin(), sizes.end()), 25);
    }
  }
}

TEST(Superpixels, OfAPlainImageHaveTheSizeAskedFor) {
  const auto device = CreateTestDevice(1);
  const Superpixels superpixels =
      Compute(Image<Rgb>(120, 100, {90, 90, 90}), 100, *device);
  EXPECT_NEAR(superpixels.count, 120, 12);
}

TEST(Superpixels, DoNotCrossAColorEdge) {
  const auto device = CreateTestDevice(1);
  // The edge lies at every offset to the grid of clusters, straight or slanted.
  for (const double slope : {0.0, 0.4}) {
    for (int offset = 60; offset < 80; offset += 3) {
      Image<Rgb> color(140, 60, {20, 40, 60});
      ForEachPixel(140, 60, [&](int x, int y) {
        if (x >= offset + slope * (y - 30)) {
          color(x, y) = {220, 200, 180};
        }
      });
      const Superpixels superpixels = Compute(color, 400, *device);
      const Image<int> labels = superpixels.labels.ToHost();
      CheckSegments(labels, superpixels.count);
      std::vector<int> bright(superpixels.count, -1);
      ForEachPixel(140, 60, [&](int x, int y) {
        int& side = bright[labels(x, y)];
        const int here = color(x, y).r > 100 ? 1 : 0;
        ASSERT_TRUE(side < 0 || side == here)
            << offset << ": " << x << ", " << y;
        side = here;
      });
    }
  }
}

// A badly matched cluster costs less, so it takes pixels from its neighbors.
TEST(Superpixels, BadlyMatchedOnesAttractPixels) {
  const auto device = CreateTestDevice(1);
  DeviceCopies on_device(*device);
  const Image<Rgb> color(100, 40, {90, 90, 90});
  Image<float> score(100, 40, 0.2f);
  ForEachPixel(50, 40, [&](int x, int y) { score(x, y) = 1.5f; });
  const Superpixels superpixels =
      ComputeSuperpixels(on_device(color), on_device(score), 400, *device);
  const Image<int> labels = superpixels.labels.ToHost();
  CheckSegments(labels, superpixels.count);
  // With equal scores the border lies in the middle, between columns 49 and 50.
  int moved = 0;
  for (int y = 0; y < 40; ++y) {
    moved += labels(49, y) == labels(53, y) ? 1 : 0;
  }
  EXPECT_GT(moved, 30);
}

class MergeFragmentsTest : public testing::Test {
 protected:
  MergeFragmentsTest() : device_(CreateTestDevice(2)) {}

  Image<int> Merge(const Image<int>& labels, int min_size, int* count) {
    DeviceImage<int> merged(*device_, labels);
    *count = MergeFragments(merged, min_size, *device_);
    return merged.ToHost();
  }

  std::unique_ptr<Device> device_;
};

TEST_F(MergeFragmentsTest, NumbersSegmentsByTheirFirstPixel) {
  Image<int> labels(6, 4, 70);
  for (int y = 0; y < 4; ++y) {
    labels(3, y) = 5;
    labels(4, y) = 30;
    labels(5, y) = 30;
  }
  int count = 0;
  const Image<int> merged = Merge(labels, 1, &count);
  EXPECT_EQ(count, 3);
  EXPECT_EQ(merged(0, 0), 0);
  EXPECT_EQ(merged(3, 2), 1);
  EXPECT_EQ(merged(5, 3), 2);
}

TEST_F(MergeFragmentsTest, JoinsTheLargestNeighbor) {
  // The fragment lies within the smaller half and touches the larger one with
  // one side only.
  Image<int> labels(10, 10, 0);
  ForEachPixel(6, 10, 0, 10, [&](int x, int y) { labels(x, y) = 1; });
  for (int y = 3; y < 7; ++y) {
    labels(6, y) = 2;
    labels(7, y) = 2;
  }
  int count = 0;
  const Image<int> merged = Merge(labels, 9, &count);
  EXPECT_EQ(count, 2);
  EXPECT_EQ(merged(6, 4), merged(0, 0));
  EXPECT_NE(merged(6, 4), merged(9, 9));
}

TEST_F(MergeFragmentsTest, FragmentsThatChooseEachOtherBecomeOne) {
  // Rows of one pixel's height: all are fragments of the same size, so that
  // each chooses the one above, and the first one the second.
  Image<int> labels(5, 8);
  ForEachPixel(5, 8, [&](int x, int y) { labels(x, y) = y; });
  int count = 0;
  const Image<int> merged = Merge(labels, 6, &count);
  EXPECT_EQ(count, 1);
  EXPECT_EQ(std::count(merged.begin(), merged.end(), 0), 40);
}

TEST_F(MergeFragmentsTest, LeavesNoFragmentInNoise) {
  for (uint32_t seed = 0; seed < 10; ++seed) {
    Image<int> labels(53, 41);
    Philox random(seed, 0, 0);
    for (int& label : labels) {
      label = static_cast<int>(random.NextBelow(4));
    }
    int count = 0;
    const Image<int> merged = Merge(labels, 20, &count);
    const std::vector<int> sizes = CheckSegments(merged, count);
    EXPECT_GT(count, 1);
    EXPECT_GE(*std::min_element(sizes.begin(), sizes.end()), 20);
  }
}

}  // namespace
}  // namespace tsar
