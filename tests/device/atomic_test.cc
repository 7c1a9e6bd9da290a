// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/atomic.h"

#include "colmap_tsar/device/parallel_for.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int64_t kCount = 20000;

// Numbers that do not fit into 32 bits, each once, in a mixed order.
uint64_t Mixed(int64_t i) {
  return static_cast<uint64_t>(i * 7919 % kCount) << 32 | 5u;
}

TEST(Atomic, MaxOfLongNumbersDoesNotDependOnThreads) {
  const auto device = Device::CreateCpu(4);
  uint64_t max = 0;
  ParallelFor(
      *device, kCount, [&max](int64_t i) { AtomicMax(&max, Mixed(i)); });
  EXPECT_EQ(max, static_cast<uint64_t>(kCount - 1) << 32 | 5u);
  EXPECT_EQ(AtomicMax(&max, uint64_t{3}), max);
}

TEST(Atomic, SumOfLongNumbersLosesNone) {
  const auto device = Device::CreateCpu(4);
  const int64_t step = int64_t{1} << 33;
  int64_t sum = 0;
  ParallelFor(*device, kCount, [&](int64_t i) {
    AtomicAdd(&sum, i % 2 == 0 ? -step : 3 * step);
  });
  EXPECT_EQ(sum, kCount * step);
  EXPECT_EQ(AtomicAdd(&sum, int64_t{-1}), kCount * step);
  EXPECT_EQ(sum, kCount * step - 1);
}

}  // namespace
}  // namespace tsar
