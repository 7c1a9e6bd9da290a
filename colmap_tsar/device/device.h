// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"

#include <cstddef>
#include <memory>
#include <string>

namespace tsar {

enum class DeviceKind { kCpu, kCuda };

// Where the loops of the stages run: the threads of the CPU, or one GPU with
// one stream. Work on one device is done in the order in which it was asked
// for. A device is used by one thread at a time; several devices may be used
// side by side.
class Device {
 public:
  virtual ~Device() = default;

  // num_threads < 1 means one thread per core.
  static std::unique_ptr<Device> CreateCpu(int num_threads);

  // The GPU with this index in CUDA's order. Throws kDevice when the program
  // was built without CUDA, there is no such GPU, or the program holds no code
  // for it.
  static std::unique_ptr<Device> CreateCuda(int gpu_index, int num_threads);

  // How many GPUs the driver reports: 0 without CUDA or without a driver.
  static int NumCudaDevices();

  bool IsCuda() const { return kind_ == DeviceKind::kCuda; }
  virtual std::string Name() const = 0;

  // Threads for the loops that run on the host.
  ThreadPool& Threads() { return threads_; }

  // Memory that this device's loops can read and write, not initialised.
  virtual void* Allocate(size_t num_bytes) = 0;
  virtual void Free(void* memory) noexcept = 0;

  // Copies between memory of the host and of this device. Both return when the
  // host memory may be changed or read.
  virtual void CopyToDevice(void* target, const void* source, size_t size) = 0;
  virtual void CopyToHost(void* target, const void* source, size_t size) = 0;

  // Returns when all work that was asked for is done. Throws kDevice when any
  // of it failed.
  virtual void Synchronize() = 0;

 protected:
  Device(DeviceKind kind, int num_threads)
      : kind_(kind), threads_(num_threads) {}

 private:
  DeviceKind kind_;
  ThreadPool threads_;
};

}  // namespace tsar
