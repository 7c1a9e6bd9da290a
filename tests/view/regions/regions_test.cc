// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/regions.h"

#include <algorithm>
#include <cstdlib>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class RegionsTest : public testing::Test {
 protected:
  RegionsTest() : device_(CreateTestDevice(2)) {}

  Image<int> Find(const Image<uint8_t>& edges, int min_size, int* count) {
    const Regions regions = FindRegions(on_device_(edges), min_size, *device_);
    *count = regions.count;
    return regions.labels.ToHost();
  }
  Image<int> Grow(const Image<int>& labels, int num_steps) {
    return GrowLabels(on_device_(labels), num_steps, *device_).ToHost();
  }
  Image<int> Shrink(const Image<int>& labels, int num_steps) {
    return ShrinkLabels(on_device_(labels), num_steps, *device_).ToHost();
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
};

TEST_F(RegionsTest, AreTheFieldsOfAGridInRasterOrder) {
  Image<uint8_t> edges(32, 24, 0);
  ForEachPixel(32, 24, [&](int x, int y) {
    edges(x, y) = x % 8 == 7 || y % 8 == 7 ? 255 : 0;
  });
  int count = 0;
  const Image<int> labels = Find(edges, 48, &count);
  EXPECT_EQ(count, 12);
  ForEachPixel(32, 24, [&](int x, int y) {
    ASSERT_EQ(labels(x, y), edges(x, y) ? -1 : x / 8 + 4 * (y / 8));
  });
  // Each field has 49 pixels; regions must have more than the least size.
  Find(edges, 49, &count);
  EXPECT_EQ(count, 0);
}

TEST_F(RegionsTest, DoNotLeakThroughAThinSlantedLine) {
  for (const int end : {0, 13, 31, 50, 63}) {
    Image<uint8_t> edges(64, 64, 0);
    for (int y = 0; y < 64; ++y) {
      // One pixel in each row, from column 63 - end to column end.
      edges(63 - end + (2 * end - 63) * y / 63, y) = 1;
    }
    int count = 0;
    const Image<int> labels = Find(edges, 10, &count);
    EXPECT_EQ(count, 2) << end;
    EXPECT_NE(labels(0, 32), labels(63, 32));
  }
}

TEST_F(RegionsTest, SmallAreasHaveNoNumber) {
  // Columns of 5, 1, 5 and 2 pixels' width between lines.
  Image<uint8_t> edges(16, 3, 0);
  for (int y = 0; y < 3; ++y) {
    for (const int x : {5, 7, 13}) {
      edges(x, y) = 1;
    }
  }
  int count = 0;
  const Image<int> labels = Find(edges, 6, &count);
  EXPECT_EQ(count, 2);
  for (int x = 0; x < 16; ++x) {
    EXPECT_EQ(labels(x, 1), x < 5 ? 0 : x > 7 && x < 13 ? 1 : -1) << x;
  }
}

TEST_F(RegionsTest, OfAnImageWithoutEdgesIsOne) {
  int count = 0;
  const Image<int> labels = Find(Image<uint8_t>(17, 5, 0), 84, &count);
  EXPECT_EQ(count, 1);
  EXPECT_EQ(std::count(labels.begin(), labels.end(), 0), 85);
  Find(Image<uint8_t>(17, 5, 1), 0, &count);
  EXPECT_EQ(count, 0);
}

TEST_F(RegionsTest, GrowByOnePixelPerStep) {
  Image<int> labels(21, 21, -1);
  labels(10, 10) = 3;
  for (const int num_steps : {0, 1, 4}) {
    const Image<int> grown = Grow(labels, num_steps);
    ForEachPixel(21, 21, [&](int x, int y) {
      const int distance = std::abs(x - 10) + std::abs(y - 10);
      ASSERT_EQ(grown(x, y), distance <= num_steps ? 3 : -1);
    });
  }
}

TEST_F(RegionsTest, GrowNeverIntoAnother) {
  Image<int> labels(12, 4, -1);
  for (int y = 0; y < 4; ++y) {
    labels(0, y) = 5;
    labels(1, y) = 2;
    labels(7, y) = 9;
  }
  const Image<int> grown = Grow(labels, 100);
  for (int y = 0; y < 4; ++y) {
    ASSERT_EQ(grown(0, y), 5);
    ASSERT_EQ(grown(1, y), 2);
    ASSERT_EQ(grown(3, y), 2);
    // Both reach the middle in the third step; the smaller label takes it.
    ASSERT_EQ(grown(4, y), 2);
    ASSERT_EQ(grown(5, y), 9);
    ASSERT_EQ(grown(11, y), 9);
  }
}

TEST_F(RegionsTest, ShrinkByOnePixelPerStepButNotFromTheImagesBorder) {
  Image<int> labels(20, 10, 1);
  for (int y = 0; y < 10; ++y) {
    labels(12, y) = -1;
    for (int x = 13; x < 20; ++x) {
      labels(x, y) = 4;
    }
  }
  const Image<int> shrunk = Shrink(labels, 2);
  ForEachPixel(20, 10, [&](int x, int y) {
    ASSERT_EQ(shrunk(x, y), x < 10 ? 1 : x < 15 ? -1 : 4) << x << ", " << y;
  });
  const Image<int> same = Shrink(labels, 0);
  EXPECT_TRUE(std::equal(labels.begin(), labels.end(), same.begin()));
}

TEST_F(RegionsTest, ThatTouchShrinkOnBothSides) {
  Image<int> labels(10, 3, 0);
  ForEachPixel(5, 10, 0, 3, [&](int x, int y) { labels(x, y) = 1; });
  const Image<int> shrunk = Shrink(labels, 1);
  EXPECT_EQ(shrunk(3, 1), 0);
  EXPECT_EQ(shrunk(4, 1), -1);
  EXPECT_EQ(shrunk(5, 1), -1);
  EXPECT_EQ(shrunk(6, 1), 1);
}

}  // namespace
}  // namespace tsar
