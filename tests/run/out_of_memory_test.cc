// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// A program of its own: it replaces operator new by one that fails on demand.

#include "colmap_tsar/run/device_view_cache.h"
#include "colmap_tsar/run/view_cache.h"

#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#include <gtest/gtest.h>

namespace {

// Allocations of this thread until one fails; negative: none does.
thread_local int num_left = -1;

}  // namespace

// Not inline: half of a pair in a function looks like a mistake to the
// compiler.
[[gnu::noinline]] void* operator new(size_t size) {
  if (num_left == 0) {
    throw std::bad_alloc();
  }
  num_left -= num_left > 0 ? 1 : 0;
  void* const memory = std::malloc(size == 0 ? 1 : size);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t /*size*/) noexcept {
  std::free(memory);
}

namespace tsar {
namespace {

constexpr size_t kViewBytes = 400;

ViewCache::View MakeView(int image) {
  auto view = std::make_shared<ViewData>();
  view->depth = Image<float>(100, 1, static_cast<float>(image));
  return view;
}

// Whether the function had memory for so many allocations; all fail after them.
template <typename Function>
bool HasEnough(int num_allocations, const Function& function) {
  num_left = num_allocations;
  try {
    function();
  } catch (const std::bad_alloc&) {
    num_left = -1;
    return false;
  }
  num_left = -1;
  return true;
}

// Whoever waits for room would wait for ever if something were left reserved.
TEST(ViewCacheWithoutMemory, NothingStaysReserved) {
  int num_failures = 0;
  for (bool is_done = false; !is_done;) {
    ViewCache cache(2 * kViewBytes, kViewBytes, &MakeView);
    { cache.Reserve({7, 8}); }
    is_done = HasEnough(num_failures, [&] { cache.Reserve({1, 2}); });
    num_failures += is_done ? 0 : 1;
    ViewCache::Lease lease = cache.Reserve({3, 4});
    ASSERT_TRUE(lease.Load([] { return false; }));
    EXPECT_EQ(lease.Get(4).depth(0, 0), 4.f);
    EXPECT_EQ(cache.NumBytes(), 2 * kViewBytes);
  }
  EXPECT_GE(num_failures, 4);
}

TEST(ViewCacheWithoutMemory, ALoadIsTriedAgain) {
  int num_failures = 0;
  for (bool is_done = false; !is_done;) {
    ViewCache cache(4 * kViewBytes, kViewBytes, &MakeView);
    ViewCache::Lease lease = cache.Reserve({1, 2});
    const auto load = [&] { EXPECT_TRUE(lease.Load([] { return false; })); };
    is_done = HasEnough(num_failures, load);
    num_failures += is_done ? 0 : 1;
    load();
    EXPECT_EQ(lease.Get(2).depth(0, 0), 2.f);
  }
  EXPECT_GE(num_failures, 2);
}

// Also by a destructor.
TEST(ViewCacheWithoutMemory, GivesViewsBack) {
  ViewCache cache(0, kViewBytes, &MakeView);
  ViewCache::Lease lease = cache.Reserve({1, 2, 3});
  ASSERT_TRUE(lease.Load([] { return false; }));
  EXPECT_TRUE(HasEnough(0, [&] {
    lease.Release(2);
    const ViewCache::Lease last = std::move(lease);
  }));
  EXPECT_EQ(cache.NumBytes(), 0u);
}

TEST(DeviceViewCacheWithoutMemory, IsAsBefore) {
  const auto device = Device::CreateCpu(1);
  ViewData view;
  view.depth = Image<float>(20, 5, 3.f);
  view.color = Image<Rgb>(20, 5, {3, 0, 0});
  int num_failures = 0;
  for (bool is_done = false; !is_done;) {
    DeviceViewCache cache(1);
    cache.Get(1, view, *device);
    const size_t num_bytes = cache.NumBytes();
    is_done = HasEnough(num_failures, [&] { cache.Get(2, view, *device); });
    if (!is_done) {
      ++num_failures;
      EXPECT_LE(cache.NumBytes(), num_bytes);
    }
    for (const int image : {1, 2, 3}) {
      EXPECT_EQ(cache.Get(image, view, *device)->depth.ToHost()(19, 4), 3.f);
    }
    EXPECT_EQ(cache.NumBytes(), num_bytes);
  }
  EXPECT_GE(num_failures, 4);
}

}  // namespace
}  // namespace tsar
