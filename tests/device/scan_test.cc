// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/scan.h"

#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

std::vector<int> Sum(const std::vector<int>& values) {
  const auto device = Device::CreateCpu(2);
  const Buffer<int> buffer(*device, values);
  return ExclusiveSum(buffer.Data(), buffer.Size(), *device).ToHost();
}

TEST(ExclusiveSum, AddsWhatComesBefore) {
  EXPECT_EQ(Sum({3, 0, -5, 7}), std::vector<int>({0, 3, 3, -2, 5}));
}

TEST(ExclusiveSum, OfNothingIsZero) {
  EXPECT_EQ(Sum({}), std::vector<int>({0}));
}

TEST(ExclusiveSum, OfOnesCounts) {
  for (const int count : {1, 2, 997, 70001}) {
    const std::vector<int> sums = Sum(std::vector<int>(count, 1));
    ASSERT_EQ(sums.size(), static_cast<size_t>(count) + 1);
    for (int i = 0; i <= count; ++i) {
      ASSERT_EQ(sums[i], i);
    }
  }
}

}  // namespace
}  // namespace tsar
