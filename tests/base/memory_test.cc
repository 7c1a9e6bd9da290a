// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/main_memory.h"

#include <cstdint>
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

// Limits of a control group, of its parents, of a container that sees them at
// its root, and of version 1, with what the kernel writes for no limit.
TEST_F(MainMemoryTest, IsTheLeastLimitOfTheMachineAndTheGroupsAround) {
  EXPECT_EQ(MainMemoryBytes(root_), kMachine);
  Put("proc/self/cgroup", "5:cpu:/a\n4:memory:/a/b\n0::/job/step\n");
  struct Step {
    const char* path;
    const char* text;
    int64_t expected;
  };
  for (const auto& [path, text, expected] :
       {Step{"job/memory.max", "max\n", kMachine},
        Step{"job/step/memory.max", "99000000000000\n", kMachine},
        Step{"memory/a/b/memory.limit_in_bytes",
             "9223372036854771712\n",
             kMachine},
        Step{"memory/a/memory.limit_in_bytes", "5000000000\n", 5000000000},
        Step{"memory.max", "4000000000\n", 4000000000},
        Step{"job/memory.max", "3000000000\n", 3000000000},
        Step{"job/step/memory.max", "2000000000\n", 2000000000}}) {
    Put(std::string("sys/fs/cgroup/") + path, text);
    EXPECT_EQ(MainMemoryBytes(root_), expected) << path;
  }
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
