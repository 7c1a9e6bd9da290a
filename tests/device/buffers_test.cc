// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/device/parallel_for.h"

#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Buffer, MovesItsMemory) {
  const auto device = Device::CreateCpu(1);
  Buffer<int> first(*device, std::vector<int>{1, 2, 3});
  const int* data = first.Data();
  Buffer<int> second(std::move(first));
  EXPECT_EQ(second.Data(), data);
  EXPECT_EQ(first.Size(), 0u);
  Buffer<int> third(*device, std::vector<int>{9});
  third = std::move(second);
  EXPECT_EQ(third.ToHost(), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(second.Size(), 0u);
  EXPECT_EQ(second.Data(), nullptr);
}

TEST(DeviceImage, IsRowMajor) {
  const auto device = Device::CreateCpu(1);
  Image<float> host(3, 2);
  host(2, 0) = 20.f;
  host(0, 1) = 1.f;
  DeviceImage<float> image(*device, host);
  EXPECT_EQ(image.Width(), 3);
  EXPECT_EQ(image.Height(), 2);
  EXPECT_EQ(image.View()(2, 0), 20.f);
  EXPECT_EQ(image.View().data[3], 1.f);
  image.View()(1, 1) = 11.f;
  EXPECT_EQ(image.ToHost()(1, 1), 11.f);
  EXPECT_EQ(host(1, 1), 0.f);
}

TEST(Copy, CopiesSoManyElementsAndNoMore) {
  const auto device = Device::CreateCpu(3);
  for (const size_t count : {0, 1, 13, 70001}) {
    std::vector<Vec3f> values(count);
    for (size_t i = 0; i < count; ++i) {
      values[i] = {static_cast<float>(i), 2.f, -static_cast<float>(i)};
    }
    const Vec3f untouched = {7.f, 8.f, 9.f};
    const Buffer<Vec3f> source(*device, values);
    Buffer<Vec3f> target(*device, std::vector<Vec3f>(count + 1, untouched));
    Copy(*device, source.Data(), count, target.Data());
    values.push_back(untouched);
    EXPECT_EQ(target.ToHost(), values);
  }
}

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

constexpr int64_t kCount = 20000;

// Numbers that do not fit into 32 bits, each once, in a mixed order.
uint64_t Mixed(int64_t i) {
  return static_cast<uint64_t>(i * 7919 % kCount) << 32 | 5u;
}

TEST(Atomic, MaxOfLongNumbersDoesNotDependOnThreads) {
  const auto device = Device::CreateCpu(4);
  uint64_t max = 0;
  ParallelFor(
      *device, kCount, [&max](int64_t i) { AtomicMax(&max, Mixed(i)); });
  EXPECT_EQ(max, static_cast<uint64_t>(kCount - 1) << 32 | 5u);
  EXPECT_EQ(AtomicMax(&max, uint64_t{3}), max);
}

TEST(Atomic, SumOfLongNumbersLosesNone) {
  const auto device = Device::CreateCpu(4);
  const int64_t step = int64_t{1} << 33;
  int64_t sum = 0;
  ParallelFor(*device, kCount, [&](int64_t i) {
    AtomicAdd(&sum, i % 2 == 0 ? -step : 3 * step);
  });
  EXPECT_EQ(sum, kCount * step);
  EXPECT_EQ(AtomicAdd(&sum, int64_t{-1}), kCount * step);
  EXPECT_EQ(sum, kCount * step - 1);
}

}  // namespace
}  // namespace tsar
