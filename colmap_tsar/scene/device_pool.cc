// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/device_pool.h"

#include "colmap_tsar/base/error.h"

#include <numeric>
#include <utility>

namespace tsar {

DevicePool::DevicePool(std::vector<NamedDevice> devices)
    : devices_(std::move(devices)), free_(devices_.size()) {
  std::iota(free_.begin(), free_.end(), size_t{0});
}

void DevicePool::Run(const std::function<void(Device&)>& work) {
  const Loan loan(*this);
  try {
    work(*loan.Get().device);
  } catch (const Error& error) {
    throw Error(error.Code(), loan.Get().name + ": " + error.what());
  }
}

DevicePool::Loan::Loan(DevicePool& pool) : pool_(pool) {
  std::unique_lock<std::mutex> lock(pool_.mutex_);
  pool_.is_free_.wait(lock, [this] { return !pool_.free_.empty(); });
  index_ = pool_.free_.front();
  pool_.free_.erase(pool_.free_.begin());
}

DevicePool::Loan::~Loan() {
  const std::lock_guard<std::mutex> lock(pool_.mutex_);
  pool_.free_.push_back(index_);
  pool_.is_free_.notify_one();
}

}  // namespace tsar
