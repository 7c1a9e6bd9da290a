// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/raster_memory.h"

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr size_t kMegabyte = size_t{1} << 20;

TEST(RasterMemory, StaysForTheNextBlockOfTheSameSize) {
  const RasterMemoryReuse reuse(100 * kMegabyte);
  void* const first = AllocateRasterMemory(10 * kMegabyte);
  void* const second = AllocateRasterMemory(10 * kMegabyte);
  EXPECT_NE(first, second);
  FreeRasterMemory(first, 10 * kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 10 * kMegabyte);
  void* const other = AllocateRasterMemory(12 * kMegabyte);
  EXPECT_NE(other, first);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 10 * kMegabyte);
  // Blocks are whole huge pages.
  EXPECT_EQ(AllocateRasterMemory(9 * kMegabyte), first);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 0u);
  FreeRasterMemory(first, 9 * kMegabyte);
  FreeRasterMemory(second, 10 * kMegabyte);
  FreeRasterMemory(other, 12 * kMegabyte);
}

TEST(RasterMemory, WhatStaysAndWhatIsUsedHaveALimit) {
  const RasterMemoryReuse reuse(30 * kMegabyte);
  std::vector<void*> blocks;
  for (int i = 0; i < 5; ++i) {
    blocks.push_back(AllocateRasterMemory(10 * kMegabyte));
  }
  // Beyond the limit nothing stays.
  FreeRasterMemory(blocks[0], 10 * kMegabyte);
  FreeRasterMemory(blocks[1], 10 * kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 0u);
  FreeRasterMemory(blocks[2], 10 * kMegabyte);
  FreeRasterMemory(blocks[3], 10 * kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 20 * kMegabyte);
  // A block of another size takes the place of the one unused for longest.
  void* const other = AllocateRasterMemory(6 * kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 10 * kMegabyte);
  EXPECT_EQ(AllocateRasterMemory(10 * kMegabyte), blocks[3]);
  FreeRasterMemory(blocks[3], 10 * kMegabyte);
  FreeRasterMemory(blocks[4], 10 * kMegabyte);
  FreeRasterMemory(other, 6 * kMegabyte);
}

TEST(RasterMemory, NothingStaysAfterwards) {
  {
    const RasterMemoryReuse reuse(100 * kMegabyte);
    FreeRasterMemory(AllocateRasterMemory(10 * kMegabyte), 10 * kMegabyte);
    EXPECT_GT(RasterMemoryReuse::NumFreeBytes(), 0u);
  }
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 0u);
  FreeRasterMemory(AllocateRasterMemory(10 * kMegabyte), 10 * kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 0u);
}

TEST(RasterMemory, SmallBlocksAreTheLibrarys) {
  const RasterMemoryReuse reuse(100 * kMegabyte);
  FreeRasterMemory(AllocateRasterMemory(kMegabyte), kMegabyte);
  EXPECT_EQ(RasterMemoryReuse::NumFreeBytes(), 0u);
}

TEST(RasterMemory, ImagesOfReusedMemoryHaveTheValueThatTheyWereGiven) {
  const RasterMemoryReuse reuse(100 * kMegabyte);
  const float* memory = nullptr;
  {
    const Image<float> image(2000, 1000, 7.f);
    memory = image.Data();
  }
  const Image<float> image(2000, 1000);
  EXPECT_EQ(image.Data(), memory);
  EXPECT_EQ(image(0, 0), 0.f);
  EXPECT_EQ(image(1999, 999), 0.f);
}

TEST(RasterMemory, ThreadsShareIt) {
  const RasterMemoryReuse reuse(40 * kMegabyte);
  std::vector<std::jthread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([i] {
      for (int k = 0; k < 200; ++k) {
        const Image<int32_t> image(1024 * (1 + k % 3), 1024, i);
        EXPECT_EQ(image(1023, 1023), i);
      }
    });
  }
  threads.clear();
  EXPECT_LE(RasterMemoryReuse::NumFreeBytes(), 40 * kMegabyte);
}

}  // namespace
}  // namespace tsar
