// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/device/device.h"

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <mutex>
#include <numeric>
#include <string>
#include <utility>
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
  explicit DevicePool(std::vector<NamedDevice> devices)
      : devices_(std::move(devices)), free_(devices_.size()) {
    std::iota(free_.begin(), free_.end(), size_t{0});
  }

  size_t Size() const { return devices_.size(); }

  // Waits until a device is free and calls the work with it. The pool must not
  // be empty. An Error gets the device's name.
  void Run(const std::function<void(Device&)>& work) {
    const Loan loan(*this);
    const NamedDevice& device = devices_[loan.index];
    try {
      work(*device.device);
    } catch (const Error& error) {
      throw Error(error.Code(), device.name + ": " + error.what());
    }
  }

 private:
  // Holds a device for its own lifetime.
  struct Loan {
    explicit Loan(DevicePool& pool) : pool(pool) {
      std::unique_lock<std::mutex> lock(pool.mutex_);
      pool.is_free_.wait(lock, [&] { return !pool.free_.empty(); });
      index = pool.free_.front();
      pool.free_.erase(pool.free_.begin());
    }
    ~Loan() {
      const std::lock_guard<std::mutex> lock(pool.mutex_);
      pool.free_.push_back(index);
      pool.is_free_.notify_one();
    }
    Loan(const Loan&) = delete;
    Loan& operator=(const Loan&) = delete;

    DevicePool& pool;
    size_t index = 0;
  };

  const std::vector<NamedDevice> devices_;
  std::mutex mutex_;
  std::condition_variable is_free_;
  // Indices of free devices, the one that was idle longest first; the capacity
  // is reserved, so that returning one cannot fail.
  std::vector<size_t> free_;
};

}  // namespace tsar
