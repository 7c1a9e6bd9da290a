// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/main_memory.h"

#include <filesystem>
#include <fstream>
#include <string>

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

}  // namespace
}  // namespace tsar
