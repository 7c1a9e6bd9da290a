// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/device.h"

#include "colmap_tsar/base/error.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Device, CpuHasTheThreadsItWasAskedFor) {
  for (const int num_threads : {1, 2, 7}) {
    const auto device = Device::CreateCpu(num_threads);
    EXPECT_EQ(device->Threads().NumThreads(), num_threads);
    EXPECT_FALSE(device->IsCuda());
    EXPECT_EQ(device->Name(), "CPU");
  }
}

TEST(Device, ThereIsNoGpuBeyondTheLast) {
  try {
    Device::CreateCuda(Device::NumCudaDevices());
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.Code(), ErrorCode::kDevice);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace tsar
