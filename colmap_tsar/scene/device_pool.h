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

// A device that the caller owns, and its name in messages.
struct NamedDevice {
  std::string name;
  Device* device = nullptr;
};

// Devices shared by a larger number of threads: a thread has exclusive use of
// one while it works, the one that was idle longest.
class DevicePool {
 public:
  explicit DevicePool(std::vector<NamedDevice> devices);

  size_t Size() const { return devices_.size(); }

  // Waits until a device is free and calls the work with it. The pool must not
  // be empty. An Error gets the device's name.
  void Run(const std::function<void(Device&)>& work);

 private:
  // Holds a device for its own lifetime.
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
  // Indices of free devices, the one that was idle longest first; the capacity
  // is reserved, so that returning one cannot fail.
  std::vector<size_t> free_;
};

}  // namespace tsar
