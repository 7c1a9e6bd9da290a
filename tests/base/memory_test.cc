// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/main_memory.h"
#include "colmap_tsar/base/raster_memory.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

class MainMemoryTest : public testing::Test {
 protected:
  MainMemoryTest()
      : root_(std::filesystem::path(testing::TempDir()) /
              (std::string("main_memory_") +
               testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(root_);
    Put("proc/meminfo",
        "MemTotal:       16000000 kB\nMemFree:         1000000 kB\n"
        "HugePages_Total:       0\n");
  }
  ~MainMemoryTest() override { std::filesystem::remove_all(root_); }

  void Put(const std::string& path, const std::string& text) {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path) << text;
  }

  std::filesystem::path root_;
};

constexpr int64_t kMachine = int64_t{16000000} * 1024;

TEST_F(MainMemoryTest, IsTheMachinesWithoutGroups) {
  EXPECT_EQ(MainMemoryBytes(root_), kMachine);
  // A group without a limit of its own.
  Put("proc/self/cgroup", "0::/job/step\n");
  Put("sys/fs/cgroup/job/memory.max", "max\n");
  EXPECT_EQ(MainMemoryBytes(root_), kMachine);
}

TEST_F(MainMemoryTest, FindsTheSmallestLimitOfTheGroupsAround) {
  Put("proc/self/cgroup", "0::/job/step\n");
  Put("sys/fs/cgroup/job/memory.max", "3000000000\n");
  Put("sys/fs/cgroup/job/step/memory.max", "max\n");
  EXPECT_EQ(MainMemoryBytes(root_), 3000000000);
  Put("sys/fs/cgroup/job/step/memory.max", "2000000000\n");
  EXPECT_EQ(MainMemoryBytes(root_), 2000000000);
  // More than there is.
  Put("sys/fs/cgroup/job/memory.max", "99000000000000\n");
  Put("sys/fs/cgroup/job/step/memory.max", "99000000000000\n");
  EXPECT_EQ(MainMemoryBytes(root_), kMachine);
}

TEST_F(MainMemoryTest, FindsALimitThatAContainerSeesAtItsRoot) {
  Put("proc/self/cgroup", "0::/outside/docker/0123\n");
  Put("sys/fs/cgroup/memory.max", "4000000000\n");
  EXPECT_EQ(MainMemoryBytes(root_), 4000000000);
}

TEST_F(MainMemoryTest, KnowsTheFirstVersionOfGroups) {
  Put("proc/self/cgroup", "5:cpu:/a\n4:memory:/a/b\n0::/\n");
  Put("sys/fs/cgroup/memory/a/memory.limit_in_bytes", "5000000000\n");
  // What the kernel writes where there is no limit.
  Put("sys/fs/cgroup/memory/a/b/memory.limit_in_bytes",
      "9223372036854771712\n");
  EXPECT_EQ(MainMemoryBytes(root_), 5000000000);
}

TEST_F(MainMemoryTest, IsWithoutBoundWhereNothingTells) {
  Put("proc/self/cgroup", "nonsense\n:\n");
  Put("proc/meminfo", "nothing of use\n");
  EXPECT_EQ(MainMemoryBytes(root_), INT64_MAX);
  EXPECT_EQ(MainMemoryBytes(root_ / "missing"), INT64_MAX);
}

TEST(MainMemoryBytes, IsKnownOnThisMachine) {
  EXPECT_GT(MainMemoryBytes(), int64_t{1} << 26);
  EXPECT_LT(MainMemoryBytes(), int64_t{1} << 50);
}

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
