// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/device_pool.h"

#include "colmap_tsar/base/error.h"

#include <utility>

namespace tsar {

void DevicePool::Run(const std::function<void(Device&)>& work) {
  NamedDevice lent;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    is_free_.wait(lock, [this] { return !free_.empty(); });
    lent = std::move(free_.front());
    free_.pop_front();
  }
  const auto give_back = [&] {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(lent);
    is_free_.notify_one();
  };
  try {
    work(*lent.device);
  } catch (const Error& error) {
    give_back();
    throw Error(error.Code(), lent.name + ": " + error.what());
  } catch (...) {
    give_back();
    throw;
  }
  give_back();
}

}  // namespace tsar
