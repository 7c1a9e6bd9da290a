// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/view_cache.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr size_t kViewBytes = 400;

// A view that knows its image.
ViewCache::View MakeView(int image) {
  auto view = std::make_shared<ViewData>();
  view->depth = Image<float>(100, 1, static_cast<float>(image));
  return view;
}

bool Never() { return false; }

int Load(ViewCache& cache, int image) {
  ViewCache::Lease lease = cache.Reserve({image});
  EXPECT_TRUE(lease.Load(&Never));
  return static_cast<int>(lease.Get(image).depth(0, 0));
}

TEST(ViewCache, DropsTheViewsThatWereUsedLongestAgo) {
  std::vector<int> loads;
  ViewCache cache(1000, kViewBytes, [&](int image) {
    loads.push_back(image);
    return MakeView(image);
  });
  EXPECT_EQ(Load(cache, 1), 1);
  Load(cache, 2);
  Load(cache, 1);
  Load(cache, 3);
  EXPECT_EQ(cache.NumBytes(), 800u);
  Load(cache, 1);
  Load(cache, 3);
  EXPECT_EQ(loads, (std::vector<int>{1, 2, 3}));
  Load(cache, 2);
  EXPECT_EQ(loads.size(), 4u);
}

TEST(ViewCache, WithoutMemoryHoldsWhatIsInUse) {
  ViewCache cache(0, kViewBytes, &MakeView);
  ViewCache::Lease lease = cache.Reserve({1, 2, 2});
  EXPECT_TRUE(lease.Load(&Never));
  EXPECT_EQ(lease.Get(1).depth(0, 0), 1.f);
  EXPECT_EQ(lease.Get(2).depth(0, 0), 2.f);
  EXPECT_EQ(cache.NumBytes(), 800u);
  lease.Release(1);
  EXPECT_EQ(cache.NumBytes(), 400u);
  EXPECT_EQ(lease.Get(2).depth(0, 0), 2.f);
  lease = {};
  EXPECT_EQ(cache.NumBytes(), 0u);
}

TEST(ViewCache, CountsViewsAsTheyAre) {
  ViewCache cache(5000, 1000, &MakeView);
  ViewCache::Lease lease = cache.Reserve({1});
  EXPECT_EQ(cache.NumBytes(), 1000u);
  EXPECT_TRUE(lease.Load(&Never));
  EXPECT_EQ(cache.NumBytes(), 400u);
}

TEST(ViewCache, AReservationWaitsForRoom) {
  ViewCache cache(800, kViewBytes, &MakeView);
  ViewCache::Lease lease = cache.Reserve({1, 2});
  std::atomic<bool> is_released = false;
  std::jthread other([&] {
    ViewCache::Lease second = cache.Reserve({2, 3});
    EXPECT_TRUE(is_released);
    EXPECT_TRUE(second.Load(&Never));
    EXPECT_EQ(second.Get(3).depth(0, 0), 3.f);
  });
  EXPECT_TRUE(lease.Load(&Never));
  is_released = true;
  lease.Release(1);
  other.join();
  EXPECT_EQ(cache.NumBytes(), 800u);
}

TEST(ViewCache, ThreadsShareTheLoads) {
  std::atomic<int> num_loads = 0;
  ViewCache cache(100000, kViewBytes, [&](int image) {
    ++num_loads;
    std::this_thread::yield();
    return MakeView(image);
  });
  std::vector<std::jthread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (int image = 0; image < 50; image += 5) {
        ViewCache::Lease lease =
            cache.Reserve({image, image + 1, image + 2, image + 3, image + 4});
        EXPECT_TRUE(lease.Load(&Never));
        for (int k = 0; k < 5; ++k) {
          EXPECT_EQ(lease.Get(image + k).depth(0, 0), image + k);
        }
      }
    });
  }
  threads.clear();
  EXPECT_EQ(num_loads, 50);
  EXPECT_EQ(cache.NumBytes(), 50u * kViewBytes);
}

// Views that are alive, wherever they are held.
TEST(ViewCache, ManyViewsNeedTheMemoryOfFew) {
  constexpr int kNumImages = 5000;
  constexpr int kMaxViews = 40;
  std::atomic<int> num_alive = 0;
  std::atomic<int> max_alive = 0;
  ViewCache cache(kMaxViews * kViewBytes, kViewBytes, [&](int image) {
    const int count = ++num_alive;
    int before = max_alive;
    while (before < count && !max_alive.compare_exchange_weak(before, count)) {
    }
    const ViewCache::View view = MakeView(image);
    return ViewCache::View(
        view.get(), [&num_alive, view](const ViewData*) { --num_alive; });
  });
  std::atomic<int> next = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 6; ++i) {
    threads.emplace_back([&] {
      for (int image = next++; image < kNumImages; image = next++) {
        std::vector<int> images;
        for (int k = 0; k <= 10; ++k) {
          images.push_back((image + 7 * k) % kNumImages);
        }
        ViewCache::Lease lease = cache.Reserve(images);
        EXPECT_TRUE(lease.Load(&Never));
      }
    });
  }
  threads.clear();
  EXPECT_LE(max_alive, kMaxViews);
  EXPECT_GE(max_alive, 11);
}

TEST(ViewCache, AFailedLoadIsTriedAgain) {
  int num_loads = 0;
  ViewCache cache(1000, kViewBytes, [&](int image) {
    if (++num_loads == 1) {
      throw Error(ErrorCode::kIo, "a.bin: gone; look for it");
    }
    return MakeView(image);
  });
  EXPECT_THROW(Load(cache, 1), Error);
  EXPECT_EQ(cache.NumBytes(), 0u);
  EXPECT_EQ(Load(cache, 1), 1);
}

TEST(ViewCache, StopsBetweenViews) {
  int num_loads = 0;
  ViewCache cache(10000, kViewBytes, [&](int image) {
    ++num_loads;
    return MakeView(image);
  });
  ViewCache::Lease lease = cache.Reserve({1, 2, 3, 4});
  EXPECT_FALSE(lease.Load([&] { return num_loads == 2; }));
  EXPECT_EQ(num_loads, 2);
  // Reserved, but never loaded.
  lease = {};
  EXPECT_EQ(cache.NumBytes(), 800u);
}

}  // namespace
}  // namespace tsar
