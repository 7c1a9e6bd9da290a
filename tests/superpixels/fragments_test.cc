// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/superpixels/fragments.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>

#include "tests/superpixels/segment_checks.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class MergeFragmentsTest : public testing::Test {
 protected:
  MergeFragmentsTest() : device_(Device::CreateCpu(2)) {}

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

TEST_F(MergeFragmentsTest, SplitsALabelThatIsNotConnected) {
  Image<int> labels(9, 5, 0);
  for (int y = 0; y < 5; ++y) {
    labels(4, y) = 1;
  }
  int count = 0;
  const Image<int> merged = Merge(labels, 1, &count);
  EXPECT_EQ(count, 3);
  EXPECT_NE(merged(0, 0), merged(8, 0));
}

TEST_F(MergeFragmentsTest, JoinsTheLargestNeighbour) {
  // The fragment lies within the smaller half and touches the larger one with
  // one side only.
  Image<int> labels(10, 10, 0);
  for (int y = 0; y < 10; ++y) {
    for (int x = 6; x < 10; ++x) {
      labels(x, y) = 1;
    }
  }
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

TEST_F(MergeFragmentsTest, JoinsTheFirstOfEqualNeighbours) {
  // Columns of 4, 2 and 4 pixels' width.
  Image<int> labels(10, 10, 7);
  for (int y = 0; y < 10; ++y) {
    for (int x = 4; x < 10; ++x) {
      labels(x, y) = x < 6 ? 9 : 2;
    }
  }
  int count = 0;
  const Image<int> merged = Merge(labels, 30, &count);
  EXPECT_EQ(count, 2);
  for (int x = 0; x < 10; ++x) {
    EXPECT_EQ(merged(x, 5), x < 6 ? 0 : 1) << x;
  }
}

TEST_F(MergeFragmentsTest, FragmentsThatChooseEachOtherBecomeOne) {
  // Rows of one pixel's height: all are fragments of the same size, so that
  // each chooses the one above, and the first one the second.
  Image<int> labels(5, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 5; ++x) {
      labels(x, y) = y;
    }
  }
  int count = 0;
  const Image<int> merged = Merge(labels, 6, &count);
  EXPECT_EQ(count, 1);
  EXPECT_EQ(std::count(merged.begin(), merged.end(), 0), 40);
}

TEST_F(MergeFragmentsTest, KeepsWhatIsLargeEnough) {
  Image<int> labels(10, 10, 0);
  labels(4, 4) = 1;
  labels(5, 4) = 1;
  labels(4, 5) = 1;
  int count = 0;
  Merge(labels, 3, &count);
  EXPECT_EQ(count, 2);
  Merge(labels, 4, &count);
  EXPECT_EQ(count, 1);
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

TEST_F(MergeFragmentsTest, DoesNotDependOnTheNumberOfThreads) {
  Image<int> labels(101, 67);
  Philox random(3, 0, 0);
  for (int& label : labels) {
    label = static_cast<int>(random.NextBelow(3));
  }
  int expected_count = 0;
  const Image<int> expected = Merge(labels, 15, &expected_count);
  for (const int num_threads : {1, 3, 8}) {
    const auto device = Device::CreateCpu(num_threads);
    DeviceImage<int> merged(*device, labels);
    EXPECT_EQ(MergeFragments(merged, 15, *device), expected_count);
    const Image<int> host = merged.ToHost();
    EXPECT_TRUE(std::equal(host.begin(), host.end(), expected.begin()));
  }
}

TEST_F(MergeFragmentsTest, KeepsAnImageSmallerThanTheLeastSize) {
  int count = 0;
  const Image<int> merged = Merge(Image<int>(3, 2, 4), 100, &count);
  EXPECT_EQ(count, 1);
  EXPECT_EQ(merged(2, 1), 0);
}

}  // namespace
}  // namespace tsar
