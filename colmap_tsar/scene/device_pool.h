// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"

#include <condition_variable>
#include <cstddef>
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

// Devices that more threads than there are devices share: a thread has one for
// itself while it works, the one that was idle longest.
class DevicePool {
 public:
  explicit DevicePool(std::vector<NamedDevice> devices);

  size_t Size() const { return devices_.size(); }

  // Waits until a device is free, of which there must be one, and calls the
  // work with it. An Error gets the device's name.
  void Run(const std::function<void(Device&)>& work);

 private:
  // Holds a device from its construction on, and gives it back in the end.
  class Loan {
   public:
    explicit Loan(DevicePool& pool);
    ~Loan();
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    const NamedDevice& Get() const { return pool_.devices_[index_]; }

   private:
    DevicePool& pool_;
    size_t index_ = 0;
  };

  const std::vector<NamedDevice> devices_;
  std::mutex mutex_;
  std::condition_variable is_free_;
  // Indices, the one that was idle longest first; with room for all, so that
  // giving one back cannot fail.
  std::vector<size_t> free_;
};

}  // namespace tsar
