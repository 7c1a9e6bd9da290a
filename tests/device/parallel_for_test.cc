// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/parallel_for.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/fill.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

struct CountVisits {
  ImageView<int> visits;
  void operator()(int64_t i) const { ++visits.data[i]; }
  void operator()(int x, int y) const { visits(x, y) += 1 + x + 100000 * y; }
};

class ParallelForTest : public testing::TestWithParam<int> {
 protected:
  ParallelForTest() : device_(Device::CreateCpu(GetParam())) {}
  std::unique_ptr<Device> device_;
};

TEST_P(ParallelForTest, VisitsEachIndexOnce) {
  for (const int count : {1, 2, 3, 31, 127, 128, 129, 997}) {
    Image<int> visits(count, 1, 0);
    ParallelFor(
        *device_, static_cast<int64_t>(count), CountVisits{visits.View()});
    for (const int n : visits) {
      ASSERT_EQ(n, 1) << count;
    }
  }
}

TEST_P(ParallelForTest, VisitsEachPixelOnce) {
  const std::vector<std::pair<int, int>> sizes = {
      {1, 1}, {1, 97}, {97, 1}, {2, 3}, {31, 37}, {33, 5}, {64, 64}};
  for (const auto& [width, height] : sizes) {
    Image<int> visits(width, height, 0);
    ParallelFor(*device_, width, height, CountVisits{visits.View()});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(visits(x, y), 1 + x + 100000 * y);
      }
    }
  }
}

TEST_P(ParallelForTest, DoesNothingForAnEmptyRange) {
  const CountVisits null_kernel{};
  ParallelFor(*device_, int64_t{0}, null_kernel);
  ParallelFor(*device_, int64_t{-1}, null_kernel);
  ParallelFor(*device_, 0, 5, null_kernel);
  ParallelFor(*device_, 5, 0, null_kernel);
}

TEST_P(ParallelForTest, FillSetsTheFirstElements) {
  std::vector<float> values(101, 1.f);
  Fill(*device_, values.data(), 100, 2.5f);
  for (int i = 0; i < 100; ++i) {
    ASSERT_EQ(values[i], 2.5f);
  }
  EXPECT_EQ(values[100], 1.f);
}

INSTANTIATE_TEST_SUITE_P(Threads, ParallelForTest, testing::Values(1, 2, 7));

}  // namespace
}  // namespace tsar
