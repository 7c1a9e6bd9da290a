// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/device_view_cache.h"

#include "colmap_tsar/base/error.h"

#include <thread>
#include <vector>

#include "tests/run/counting_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr size_t kViewBytes = 2 * sizeof(float) * 100;

ViewData MakeView(int image) {
  ViewData view;
  view.depth = Image<float>(20, 5, static_cast<float>(image));
  view.color = Image<Rgb>(20, 5, {static_cast<uint8_t>(image), 0, 0});
  return view;
}

float DepthOf(const DeviceViewCache::View& view) {
  return view->depth.ToHost()(19, 4);
}

class FailingDevice : public CountingDevice {
 public:
  FailingDevice() : CountingDevice("tired", 1000000) {}
  void* Allocate(size_t num_bytes) override {
    if (is_failing) {
      throw Error(ErrorCode::kOutOfMemory, "no memory; give more");
    }
    return CountingDevice::Allocate(num_bytes);
  }
  bool is_failing = true;
};

TEST(DeviceViewCache, HoldsWhatTheStagesNeed) {
  const auto device = Device::CreateCpu(1);
  DeviceViewCache cache(1000);
  ViewData view = MakeView(7);
  view.camera.width = 20;
  const DeviceViewCache::View uploaded = cache.Get(3, view, *device);
  EXPECT_EQ(DepthOf(uploaded), 7.f);
  EXPECT_EQ(uploaded->gray.ToHost()(0, 0).word,
            MakeGrayPair(0.299f * 7, 0.299f * 7).word);
  EXPECT_EQ(uploaded->camera.width, 20);
  EXPECT_TRUE(uploaded->has_depth);
  EXPECT_FALSE(cache.Get(0, MakeView(0), *device)->has_depth);
}

TEST(DeviceViewCache, UploadsOnceWhileThereIsRoom) {
  CountingDevice device("", 1000000);
  DeviceViewCache cache(2 * kViewBytes);
  cache.Get(1, MakeView(1), device);
  cache.Get(2, MakeView(2), device);
  const int num_allocations = device.NumAllocations();
  EXPECT_EQ(DepthOf(cache.Get(1, MakeView(9), device)), 1.f);
  EXPECT_EQ(device.NumAllocations(), num_allocations);
  // The second is the one that was used longest ago.
  cache.Get(3, MakeView(3), device);
  EXPECT_EQ(cache.NumBytes(), 2 * kViewBytes);
  EXPECT_EQ(DepthOf(cache.Get(1, MakeView(9), device)), 1.f);
  EXPECT_EQ(DepthOf(cache.Get(2, MakeView(8), device)), 8.f);
}

TEST(DeviceViewCache, GivesTheMemoryOfADroppedViewToTheNext) {
  CountingDevice first("", 1000000);
  CountingDevice second("", 1000000);
  DeviceViewCache cache(kViewBytes);
  cache.Get(1, MakeView(1), first);
  // Only the color, for the time of the upload.
  EXPECT_EQ(DepthOf(cache.Get(2, MakeView(2), second)), 2.f);
  EXPECT_EQ(second.NumAllocations(), 1);
  // One of another size gets its own.
  ViewData larger = MakeView(3);
  larger.depth = Image<float>(20, 6, 3.f);
  larger.color = Image<Rgb>(20, 6);
  EXPECT_EQ(DepthOf(cache.Get(3, larger, second)), 3.f);
  EXPECT_EQ(second.NumAllocations(), 4);
}

TEST(DeviceViewCache, DropsNothingThatIsInUse) {
  CountingDevice device("", 1000000);
  DeviceViewCache cache(kViewBytes);
  DeviceViewCache::View first = cache.Get(1, MakeView(1), device);
  DeviceViewCache::View second = cache.Get(2, MakeView(2), device);
  EXPECT_EQ(cache.NumBytes(), 2 * kViewBytes);
  EXPECT_EQ(DepthOf(cache.Get(1, MakeView(9), device)), 1.f);
  first = nullptr;
  second = nullptr;
  cache.Get(3, MakeView(3), device);
  EXPECT_EQ(cache.NumBytes(), kViewBytes);
}

TEST(DeviceViewCache, WorkersShareOneUpload) {
  std::vector<std::unique_ptr<CountingDevice>> devices;
  for (int i = 0; i < 6; ++i) {
    devices.push_back(std::make_unique<CountingDevice>("", 1000000));
  }
  {
    DeviceViewCache cache(50 * kViewBytes);
    std::vector<std::jthread> threads;
    for (const auto& device : devices) {
      threads.emplace_back([&] {
        for (int image = 0; image < 50; ++image) {
          EXPECT_EQ(DepthOf(cache.Get(image, MakeView(image), *device)), image);
        }
      });
    }
    threads.clear();
    int num_allocations = 0;
    for (const auto& device : devices) {
      num_allocations += device->NumAllocations();
    }
    // Color, gray and depth of each.
    EXPECT_EQ(num_allocations, 3 * 50);
    EXPECT_EQ(cache.NumBytes(), 50 * kViewBytes);
  }
}

TEST(DeviceViewCache, AFailedUploadIsTriedAgain) {
  FailingDevice device;
  DeviceViewCache cache(1000);
  EXPECT_THROW(cache.Get(1, MakeView(1), device), Error);
  EXPECT_EQ(cache.NumBytes(), 0u);
  device.is_failing = false;
  EXPECT_EQ(DepthOf(cache.Get(1, MakeView(1), device)), 1.f);
}

}  // namespace
}  // namespace tsar
