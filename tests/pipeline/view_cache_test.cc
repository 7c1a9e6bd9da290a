// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/view_cache.h"

#include "colmap_tsar/base/error.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

// A view of 400 bytes that knows its image.
ViewData MakeView(int image) {
  ViewData view;
  view.depth = Image<float>(100, 1, static_cast<float>(image));
  return view;
}

int ImageOf(const ViewCache::View& view) {
  return static_cast<int>(view->depth(0, 0));
}

TEST(ViewCache, DropsTheViewsThatWereUsedLongestAgo) {
  std::vector<int> loads;
  ViewCache cache(1000, [&](int image) {
    loads.push_back(image);
    return MakeView(image);
  });
  EXPECT_EQ(ImageOf(cache.Get(1)), 1);
  cache.Get(2);
  cache.Get(1);
  cache.Get(3);
  EXPECT_EQ(cache.NumBytes(), 800u);
  cache.Get(1);
  cache.Get(3);
  EXPECT_EQ(loads, (std::vector<int>{1, 2, 3}));
  cache.Get(2);
  EXPECT_EQ(loads.size(), 4u);
}

TEST(ViewCache, AViewInUseOutlivesItsPlace) {
  ViewCache cache(0, &MakeView);
  const ViewCache::View held = cache.Get(1);
  EXPECT_EQ(ImageOf(cache.Get(2)), 2);
  EXPECT_EQ(cache.NumBytes(), 0u);
  EXPECT_EQ(ImageOf(held), 1);
}

TEST(ViewCache, ThreadsShareOneLoad) {
  std::atomic<int> num_loads = 0;
  ViewCache cache(100000, [&](int image) {
    ++num_loads;
    std::this_thread::yield();
    return MakeView(image);
  });
  std::vector<std::jthread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&] {
      for (int image = 0; image < 50; ++image) {
        EXPECT_EQ(ImageOf(cache.Get(image)), image);
      }
    });
  }
  threads.clear();
  EXPECT_EQ(num_loads, 50);
  EXPECT_EQ(cache.NumBytes(), 50u * 400u);
}

TEST(ViewCache, AFailedLoadIsTriedAgain) {
  int num_loads = 0;
  ViewCache cache(1000, [&](int image) {
    if (++num_loads == 1) {
      throw Error(ErrorCode::kIo, "a.bin: gone; look for it");
    }
    return MakeView(image);
  });
  EXPECT_THROW(cache.Get(1), Error);
  EXPECT_EQ(cache.NumBytes(), 0u);
  EXPECT_EQ(ImageOf(cache.Get(1)), 1);
}

}  // namespace
}  // namespace tsar
