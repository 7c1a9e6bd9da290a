// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/regions.h"

#include "colmap_tsar/view/regions/region_planes.h"

#include <algorithm>
#include <cstdlib>

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
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      edges(x, y) = x % 8 == 7 || y % 8 == 7 ? 255 : 0;
    }
  }
  int count = 0;
  const Image<int> labels = Find(edges, 48, &count);
  EXPECT_EQ(count, 12);
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 32; ++x) {
      ASSERT_EQ(labels(x, y), edges(x, y) ? -1 : x / 8 + 4 * (y / 8));
    }
  }
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

TEST_F(RegionsTest, OfSegmentsReachAcrossEdgesAndEndAtTheirBorders) {
  const auto find_in_row = [&](const std::vector<uint16_t>& segments,
                               const std::vector<uint8_t>& edges) {
    const int width = static_cast<int>(edges.size());
    const Image<int> labels =
        FindSegments(ImageView<const uint16_t>{segments.data(), width, 1},
                     ImageView<const uint8_t>{edges.data(), width, 1},
                     2,
                     *device_)
            .labels.ToHost();
    return std::vector<int>(labels.begin(), labels.end());
  };
  EXPECT_EQ(find_in_row({9, 9, 9, 9, 9, 0, 0, 0}, {0, 0, 1, 0, 0, 0, 0, 0}),
            (std::vector<int>{0, 0, -1, 0, 0, -1, -1, -1}));
  EXPECT_EQ(find_in_row({5, 5, 5, 300, 300, 300, 5, 5, 5},
                        {0, 0, 0, 0, 0, 0, 0, 0, 0}),
            (std::vector<int>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
  // Two pixels, or two off the edges, are too few.
  EXPECT_EQ(find_in_row({1, 1, 2, 2, 2, 3, 3, 3}, {0, 0, 0, 1, 0, 0, 0, 0}),
            (std::vector<int>{-1, -1, -1, -1, -1, 0, 0, 0}));
}

TEST_F(RegionsTest, GrowByOnePixelPerStep) {
  Image<int> labels(21, 21, -1);
  labels(10, 10) = 3;
  for (const int num_steps : {0, 1, 4}) {
    const Image<int> grown = Grow(labels, num_steps);
    for (int y = 0; y < 21; ++y) {
      for (int x = 0; x < 21; ++x) {
        const int distance = std::abs(x - 10) + std::abs(y - 10);
        ASSERT_EQ(grown(x, y), distance <= num_steps ? 3 : -1);
      }
    }
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
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      ASSERT_EQ(shrunk(x, y), x < 10 ? 1 : x < 15 ? -1 : 4) << x << ", " << y;
    }
  }
  const Image<int> same = Shrink(labels, 0);
  EXPECT_TRUE(std::equal(labels.begin(), labels.end(), same.begin()));
}

constexpr int kWidth = 40;
constexpr int kHeight = 30;
constexpr float kDepth = 4.f;

// A region of 20 x 10 pixels with 56 on its border, and a plane that faces the
// camera.
class BoundaryTest : public testing::Test {
 protected:
  BoundaryTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 50.0)) {
    Image<uint8_t> edges(kWidth, kHeight, 1);
    for (int y = 10; y < 20; ++y) {
      for (int x = 10; x < 30; ++x) {
        edges(x, y) = 0;
      }
    }
    regions_ = FindRegions(on_device_(edges), 100, *device_);
  }

  // Around the region, and nowhere else.
  void DrawSurroundings(float depth) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool is_inside = x >= 10 && x < 30 && y >= 10 && y < 20;
        depth_(x, y) = is_inside ? 0.f : depth;
      }
    }
  }
  bool Stands(float max_gap) const {
    std::vector<SupportedPlane> planes(kMaxPlanesPerRegion);
    planes[0].plane = {{0.f, 0.f, -1.f}, kDepth};
    RegionPlanes fits{{}, Buffer<SupportedPlane>(*device_, planes)};
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth_, camera_));
    RejectByBoundary(regions_,
                     samples.View(),
                     camera_.GetIntrinsics(),
                     max_gap,
                     *device_,
                     &fits);
    return fits.planes.ToHost()[0].plane.Valid();
  }

  std::unique_ptr<Device> device_;
  DeviceCopies on_device_{*device_};
  Camera camera_;
  Regions regions_;
  Image<float> depth_{kWidth, kHeight, 0.f};
};

TEST_F(BoundaryTest, ComparesTheMeanGapInTheUnitOfTheDepths) {
  for (const float gap : {0.05f, -0.05f}) {
    DrawSurroundings(kDepth + gap);
    EXPECT_TRUE(Stands(0.051f));
    EXPECT_FALSE(Stands(0.049f));
  }
}

TEST_F(BoundaryTest, OnlyNeighborsOfTheBorderCount) {
  // Inside the region and two pixels outside of it are others.
  DrawSurroundings(0.f);
  for (int x = 5; x < 35; ++x) {
    depth_(x, 15) = x > 11 && x < 28 ? 1.f : 0.f;
    depth_(x, 22) = 1.f;
  }
  EXPECT_TRUE(Stands(0.001f));
  depth_(20, 20) = kDepth + 0.5f;
  EXPECT_FALSE(Stands(0.49f));
  EXPECT_TRUE(Stands(0.51f));
}

}  // namespace
}  // namespace tsar
