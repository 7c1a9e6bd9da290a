// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// A program of its own: it replaces operator new by one that fails on demand.

#include "colmap_tsar/run/shared_cache.h"

#include <cstdlib>
#include <memory>
#include <new>

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

// Whoever waits for a value would wait for ever if it stayed claimed.
TEST(SharedCacheWithoutMemory, IsAsBefore) {
  const auto make = [](int image) {
    return std::make_shared<const int>(image);
  };
  int num_failures = 0;
  for (bool is_done = false; !is_done;) {
    SharedCache<int> cache(1);
    const auto get_all = [&] {
      return cache.GetAll({1, 2, 3}, make, [] { return false; });
    };
    cache.Get(2, [&](auto) { return make(2); });
    is_done = HasEnough(num_failures, get_all);
    num_failures += is_done ? 0 : 1;
    const auto values = get_all();
    for (int i = 0; i < 3; ++i) {
      ASSERT_NE(values[i], nullptr);
      EXPECT_EQ(*values[i], i + 1);
    }
  }
  EXPECT_GE(num_failures, 4);
}

}  // namespace
}  // namespace tsar
