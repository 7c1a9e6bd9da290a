// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace tsar {

// A device that somebody else owns, and what messages call it.
struct NamedDevice {
  std::string name;
  Device* device = nullptr;
};

// Devices that threads share, more of these than of those: whoever works has
// one for himself, and the one that waited longest is next.
class DevicePool {
 public:
  explicit DevicePool(const std::vector<NamedDevice>& devices)
      : free_(devices.begin(), devices.end()), size_(devices.size()) {}

  size_t Size() const { return size_; }

  // Waits until a device is free, of which there must be one, and calls the
  // work with it. An Error gets the device's name.
  void Run(const std::function<void(Device&)>& work);

 private:
  std::mutex mutex_;
  std::condition_variable is_free_;
  std::deque<NamedDevice> free_;
  const size_t size_;
};

}  // namespace tsar
