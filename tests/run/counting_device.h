// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <string>
#include <unordered_map>
#include <utility>

namespace tsar {

// A CPU that acts as a GPU: with a name, little memory and counters.
class CountingDevice : public Device {
 public:
  CountingDevice(std::string name, size_t memory, int num_threads = 1)
      : Device(DeviceKind::kCpu, num_threads),
        name_(std::move(name)),
        memory_(memory),
        cpu_(CreateCpu(1)) {}

  std::string Name() const override { return name_; }
  void* Allocate(size_t num_bytes) override {
    const std::lock_guard<std::mutex> lock(mutex_);
    ++num_allocations_;
    void* memory = cpu_->Allocate(num_bytes);
    sizes_[memory] = num_bytes;
    num_used_ += num_bytes;
    peak_ = std::max(peak_, num_used_);
    return memory;
  }
  void Free(void* memory) noexcept override {
    const std::lock_guard<std::mutex> lock(mutex_);
    num_used_ -= sizes_.at(memory);
    sizes_.erase(memory);
    cpu_->Free(memory);
  }
  size_t FreeMemory() override { return memory_ - num_used_; }
  size_t PeakMemory() override { return peak_; }
  void CopyToDevice(void* target, const void* source, size_t size) override {
    cpu_->CopyToDevice(target, source, size);
  }
  void CopyToHost(void* target, const void* source, size_t size) override {
    cpu_->CopyToHost(target, source, size);
  }
  void Synchronize() override {}

  int NumAllocations() const { return num_allocations_; }

 private:
  const std::string name_;
  const size_t memory_;
  const std::unique_ptr<Device> cpu_;
  std::mutex mutex_;
  std::unordered_map<void*, size_t> sizes_;
  size_t num_used_ = 0;
  size_t peak_ = 0;
  std::atomic<int> num_allocations_ = 0;
};

}  // namespace tsar
