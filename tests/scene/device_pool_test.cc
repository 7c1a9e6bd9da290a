// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/device_pool.h"

#include "colmap_tsar/base/error.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/test_workspace.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

class DevicePoolTest : public testing::Test {
 protected:
  CountingDevice first_{"a", SIZE_MAX};
  CountingDevice second_{"b", SIZE_MAX};
  DevicePool pool_{{{"GPU 0", &first_}, {"GPU 1", &second_}}};
};

TEST_F(DevicePoolTest, NobodySharesADevice) {
  std::array<std::atomic<int>, 2> num_users = {0, 0};
  std::array<std::atomic<int>, 2> num_uses = {0, 0};
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] {
        for (int k = 0; k < 50; ++k) {
          pool_.Run([&](Device& device) {
            const size_t place = &device == &first_ ? 0 : 1;
            EXPECT_EQ(++num_users[place], 1);
            ++num_uses[place];
            std::this_thread::yield();
            --num_users[place];
          });
        }
      });
    }
  }
  EXPECT_EQ(num_uses[0] + num_uses[1], 200);
  EXPECT_GT(num_uses[0], 0);
  EXPECT_GT(num_uses[1], 0);
}

TEST_F(DevicePoolTest, ADeviceComesBackFromWorkThatFailed) {
  for (int i = 0; i < 3; ++i) {
    ExpectError(ErrorCode::kOutOfMemory, {"GPU ", ": it is full"}, [&] {
      pool_.Run(
          [](Device&) { throw Error(ErrorCode::kOutOfMemory, "it is full"); });
    });
    EXPECT_THROW(pool_.Run([](Device&) { throw std::runtime_error("other"); }),
                 std::runtime_error);
  }
  int num_calls = 0;
  pool_.Run([&](Device&) { ++num_calls; });
  EXPECT_EQ(num_calls, 1);
}

}  // namespace
}  // namespace tsar
