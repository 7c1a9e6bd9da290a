// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/bounded_queue.h"

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(BoundedQueue, KeepsTheOrderAndEndsEmpty) {
  BoundedQueue<std::unique_ptr<int>> queue(3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(queue.Push(std::make_unique<int>(i)));
  }
  queue.Close();
  EXPECT_FALSE(queue.Push(std::make_unique<int>(3)));
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(**queue.Pop(), i);
  }
  EXPECT_FALSE(queue.Pop().has_value());
}

TEST(BoundedQueue, HoldsNoMoreThanItMay) {
  constexpr int kCapacity = 2;
  constexpr int kNumValues = 3000;
  BoundedQueue<int> queue(kCapacity);
  std::atomic<int> num_inside = 0;
  std::atomic<int64_t> sum = 0;
  {
    std::vector<std::jthread> takers;
    for (int i = 0; i < 3; ++i) {
      takers.emplace_back([&] {
        while (const std::optional<int> value = queue.Pop()) {
          --num_inside;
          sum += *value;
        }
      });
    }
    std::vector<std::jthread> givers;
    for (int i = 0; i < 3; ++i) {
      givers.emplace_back([&, i] {
        for (int value = i; value < kNumValues; value += 3) {
          EXPECT_TRUE(queue.Push(value));
          // Those that a taker has, but has not yet taken off, count too.
          EXPECT_LE(++num_inside, kCapacity + 3 + 3);
        }
      });
    }
    givers.clear();
    queue.Close();
  }
  EXPECT_EQ(sum, int64_t{kNumValues} * (kNumValues - 1) / 2);
  EXPECT_EQ(num_inside, 0);
}

TEST(BoundedQueue, ClosingWakesThoseWhoWait) {
  BoundedQueue<int> full(1);
  BoundedQueue<int> empty(1);
  full.Push(1);
  std::jthread giver([&] { EXPECT_FALSE(full.Push(2)); });
  std::jthread taker([&] { EXPECT_FALSE(empty.Pop().has_value()); });
  full.Close();
  empty.Close();
}

}  // namespace
}  // namespace tsar
