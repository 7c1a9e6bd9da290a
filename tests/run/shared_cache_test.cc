// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/shared_cache.h"

#include <atomic>
#include <chrono>
#include <latch>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>

namespace tsar {
namespace {

using Cache = SharedCache<int>;

bool Never() { return false; }

class SharedCacheTest : public testing::Test {
 protected:
  Cache::Pointer Get(int image) {
    return cache_.Get(image, [&](Cache::Pointer spare) {
      made_.push_back(image);
      spares_.push_back(spare ? *spare : -1);
      return std::make_shared<const int>(image);
    });
  }

  Cache cache_ = Cache(2);
  std::vector<int> made_;
  std::vector<int> spares_;  // What was dropped for each; -1: nothing.
};

TEST_F(SharedCacheTest, DropsTheValuesThatWereUsedLongestAgo) {
  EXPECT_EQ(*Get(1), 1);
  EXPECT_EQ(*Get(2), 2);
  EXPECT_EQ(*Get(1), 1);
  EXPECT_EQ(*Get(3), 3);  // In the place of 2.
  EXPECT_EQ(*cache_.Find(1), 1);
  EXPECT_EQ(cache_.Find(2), nullptr);
  EXPECT_EQ(*Get(2), 2);  // In the place of 3.
  EXPECT_THAT(made_, testing::ElementsAre(1, 2, 3, 2));
  EXPECT_THAT(spares_, testing::ElementsAre(-1, -1, 2, 3));
}

TEST_F(SharedCacheTest, KeepsWhatIsInUse) {
  const Cache::Pointer first = Get(1);
  Cache::Pointer second = Get(2);
  const Cache::Pointer third = Get(3);
  EXPECT_EQ(cache_.Find(1), first);
  EXPECT_EQ(cache_.Find(2), second);
  second.reset();
  Get(4);
  EXPECT_EQ(cache_.Find(2), nullptr);
  EXPECT_EQ(cache_.Find(3), third);
  EXPECT_THAT(spares_, testing::ElementsAre(-1, -1, -1, 2));
}

// The value that a waiting thread has yet to take must not be made another one.
TEST(SharedCache, AWaitingThreadGetsItsOwnValue) {
  const auto reuse = [](int value, Cache::Pointer spare) {
    if (spare) {
      const_cast<int&>(*spare) = value;
      return spare;
    }
    return std::make_shared<const int>(value);
  };
  for (int i = 0; i < 100; ++i) {
    Cache cache(0);
    std::atomic<bool> waits = false;
    std::jthread waiting;
    cache.Get(1, [&](Cache::Pointer spare) {
      waiting = std::jthread([&] {
        waits = true;
        const Cache::Pointer value = cache.Get(1, [&](Cache::Pointer other) {
          return reuse(1, std::move(other));
        });
        EXPECT_EQ(*value, 1);
      });
      while (!waits) {
      }
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      return reuse(1, std::move(spare));
    });
    cache.Get(2,
              [&](Cache::Pointer spare) { return reuse(2, std::move(spare)); });
  }
}

TEST_F(SharedCacheTest, DropsWhatIsNotNeeded) {
  const Cache::Pointer first = Get(1);
  std::weak_ptr<const int> second = Get(2);
  cache_.Drop(1);
  cache_.Drop(2);
  cache_.Drop(3);
  EXPECT_EQ(*first, 1);
  EXPECT_TRUE(second.expired());
  EXPECT_EQ(cache_.Find(1), nullptr);
  EXPECT_EQ(*Get(2), 2);
}

TEST_F(SharedCacheTest, AFailureIsTriedAgain) {
  EXPECT_THROW(cache_.Get(1,
                          [](Cache::Pointer) -> Cache::Pointer {
                            throw std::runtime_error("gone");
                          }),
               std::runtime_error);
  EXPECT_EQ(cache_.Find(1), nullptr);
  EXPECT_EQ(*Get(1), 1);
}

TEST_F(SharedCacheTest, AFailureReachesAllThatWait) {
  std::latch is_made(1);
  std::atomic<int> num_failures = 0;
  const auto get = [&] {
    try {
      cache_.Get(1, [&](Cache::Pointer) -> Cache::Pointer {
        is_made.wait();
        throw std::runtime_error("gone");
      });
    } catch (const std::runtime_error&) {
      ++num_failures;
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back(get);
  }
  EXPECT_EQ(cache_.Find(1), nullptr);
  is_made.count_down();
  threads.clear();
  EXPECT_EQ(num_failures, 3);
}

TEST(SharedCache, ThreadsShareTheWorkAndFewValuesAreAlive) {
  constexpr int kNumImages = 2000;
  constexpr int kNumThreads = 6;
  constexpr int kImagesOfOne = 11;
  constexpr int kMaxValues = 80;
  Cache cache(kMaxValues);
  std::atomic<int> num_alive = 0;
  std::atomic<int> max_alive = 0;
  std::atomic<int> num_made = 0;
  std::atomic<int> next = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < kNumThreads; ++i) {
    threads.emplace_back([&] {
      for (int image = next++; image < kNumImages; image = next++) {
        std::vector<int> images;
        for (int k = 0; k < kImagesOfOne; ++k) {
          images.push_back((image + k) % kNumImages);
        }
        const std::vector<Cache::Pointer> values = cache.GetAll(
            images,
            [&](int made) {
              ++num_made;
              const int count = ++num_alive;
              int before = max_alive;
              while (before < count &&
                     !max_alive.compare_exchange_weak(before, count)) {
              }
              return Cache::Pointer(new int(made), [&](const int* value) {
                --num_alive;
                delete value;
              });
            },
            &Never);
        for (int k = 0; k < kImagesOfOne; ++k) {
          EXPECT_EQ(*values[k], images[k]);
        }
      }
    });
  }
  threads.clear();
  // One value of each thread may be about to be freed.
  EXPECT_LE(max_alive, kMaxValues + kNumThreads);
  EXPECT_LT(num_made, kNumImages + kNumImages / 4);
}

TEST(SharedCache, StopsBetweenValues) {
  Cache cache(10);
  int num_made = 0;
  const std::vector<Cache::Pointer> values = cache.GetAll(
      {1, 2, 3, 4},
      [&](int image) {
        ++num_made;
        return std::make_shared<const int>(image);
      },
      [&] { return num_made == 2; });
  EXPECT_EQ(num_made, 2);
  EXPECT_EQ(*values[1], 2);
  EXPECT_EQ(values[2], nullptr);
}

}  // namespace
}  // namespace tsar
