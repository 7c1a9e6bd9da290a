// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/device.h"

#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

namespace tsar {
namespace {

class CpuDevice : public Device {
 public:
  explicit CpuDevice(int num_threads) : Device(DeviceKind::kCpu, num_threads) {}

  std::string Name() const override { return "CPU"; }

  void* Allocate(size_t num_bytes) override {
    void* memory = std::malloc(num_bytes);
    if (memory == nullptr) {
      throw std::bad_alloc();
    }
    return memory;
  }
  void Free(void* memory) noexcept override { std::free(memory); }
  size_t FreeMemory() override { return std::numeric_limits<size_t>::max(); }
  size_t PeakMemory() override { return 0; }

  void CopyToDevice(void* target, const void* source, size_t size) override {
    std::memcpy(target, source, size);
  }
  void CopyToHost(void* target, const void* source, size_t size) override {
    std::memcpy(target, source, size);
  }
  void Synchronize() override {}
};

}  // namespace

std::unique_ptr<Device> Device::CreateCpu(int num_threads) {
  return std::make_unique<CpuDevice>(num_threads);
}

}  // namespace tsar
