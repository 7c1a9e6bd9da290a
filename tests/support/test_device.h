// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"

#include <memory>
#include <vector>

namespace tsar {

// The device on which a stage is tested: the CPU with this many threads. In
// cuda_tests each test runs a second time, on a GPU, where all that it copies
// to the host must have the same bytes. So what a stage reads and writes must
// be in memory of the device.
std::unique_ptr<Device> CreateTestDevice(int num_threads = 2);

// Copies of rasters and arrays in a device's memory, which live as long as this
// object.
class DeviceCopies {
 public:
  explicit DeviceCopies(Device& device) : device_(device) {}

  template <typename T>
  ImageView<const T> operator()(const Image<T>& host) {
    auto copy = std::make_shared<const DeviceImage<T>>(device_, host);
    copies_.push_back(copy);
    return copy->View();
  }
  template <typename T>
  const T* operator()(const std::vector<T>& host) {
    auto copy = std::make_shared<const Buffer<T>>(device_, host);
    copies_.push_back(copy);
    return copy->Data();
  }

 private:
  Device& device_;
  std::vector<std::shared_ptr<const void>> copies_;
};

}  // namespace tsar
