// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/buffer.h"

#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(Buffer, HoldsWhatWasUploaded) {
  const auto device = Device::CreateCpu(1);
  const std::vector<int> host = {3, 1, 4, 1, 5};
  const Buffer<int> buffer(*device, host);
  EXPECT_EQ(buffer.Size(), 5u);
  EXPECT_EQ(buffer.ToHost(), host);
  EXPECT_NE(static_cast<const void*>(buffer.Data()), host.data());
}

TEST(Buffer, MayBeEmpty) {
  const auto device = Device::CreateCpu(1);
  const Buffer<int> nothing;
  const Buffer<int> empty(*device, std::vector<int>());
  EXPECT_EQ(nothing.Size(), 0u);
  EXPECT_EQ(nothing.Data(), nullptr);
  EXPECT_TRUE(nothing.ToHost().empty());
  EXPECT_EQ(empty.Size(), 0u);
  EXPECT_TRUE(empty.ToHost().empty());
}

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

TEST(DeviceImage, MayBeEmpty) {
  const auto device = Device::CreateCpu(1);
  EXPECT_TRUE(DeviceImage<float>().Empty());
  EXPECT_TRUE(DeviceImage<float>().View().Empty());
  EXPECT_TRUE(DeviceImage<float>(*device, 0, 5).Empty());
  EXPECT_FALSE(DeviceImage<float>(*device, 1, 1).Empty());
}

}  // namespace
}  // namespace tsar
