// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/thread_pool.h"

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

class ThreadPoolTest : public testing::TestWithParam<int> {};

TEST_P(ThreadPoolTest, VisitsEachIndexOnce) {
  ThreadPool pool(GetParam());
  EXPECT_EQ(pool.NumThreads(), GetParam());
  for (const int64_t count : {0, 1, 2, 3, 7, 55, 56, 57, 10007}) {
    std::vector<int> visits(count, 0);
    pool.Run(count, [&](int64_t begin, int64_t end) {
      ASSERT_LE(0, begin);
      ASSERT_LT(begin, end);
      ASSERT_LE(end, count);
      for (int64_t i = begin; i < end; ++i) {
        ++visits[i];
      }
    });
    EXPECT_EQ(visits, std::vector<int>(count, 1)) << count;
  }
}

TEST_P(ThreadPoolTest, RethrowsAndGoesOnWorking) {
  ThreadPool pool(GetParam());
  for (const int64_t count : {1, 1000}) {
    try {
      pool.Run(count, [](int64_t begin, int64_t) {
        if (begin == 0) {
          throw std::runtime_error("piece 0");
        }
      });
      ADD_FAILURE() << "no exception for " << count;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(error.what(), std::string("piece 0"));
    }
    std::atomic<int64_t> sum = 0;
    pool.Run(100, [&](int64_t begin, int64_t end) {
      for (int64_t i = begin; i < end; ++i) {
        sum += i;
      }
    });
    EXPECT_EQ(sum, 4950);
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, ThreadPoolTest, testing::Values(1, 2, 7));

}  // namespace
}  // namespace tsar
