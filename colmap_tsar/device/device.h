// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/thread_pool.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

enum class DeviceKind { kCpu, kCuda };

// Where the loops of the stages run: the threads of the CPU, or one GPU with
// one stream. Work on one device is done in the order in which it was asked
// for. A device is used by one thread at a time; several devices may be used
// side by side, also several of one GPU, which share its memory: what one of
// them has made and waited for (Synchronize), the others can read.
class Device {
 public:
  virtual ~Device() = default;

  // num_threads < 1 means one thread per core.
  static std::unique_ptr<Device> CreateCpu(int num_threads);

  // The GPU with this index in CUDA's order. Throws kDevice when the program
  // was built without CUDA, there is no such GPU, or the program holds no code
  // for it; kOutOfMemory when the GPU or main memory has not enough left.
  static std::unique_ptr<Device> CreateCuda(int gpu_index);

  // How many GPUs the driver reports: 0 without CUDA or without a driver.
  static int NumCudaDevices();

  // Has the driver prepare these GPUs for this program, side by side: for each
  // it takes a good part of a second, which the first CreateCuda would wait
  // for. Says nothing of GPUs that fail; CreateCuda will.
  static void PrepareCudaDevices(const std::vector<int>& gpu_indices);

  bool IsCuda() const { return kind_ == DeviceKind::kCuda; }
  virtual std::string Name() const = 0;

  // Where a CPU's loops run; of a GPU only the calling thread.
  ThreadPool& Threads() { return threads_; }

  // Memory that this device's loops can read and write, not initialized.
  virtual void* Allocate(size_t num_bytes) = 0;
  // The memory is free once all work is done that was asked of this device
  // before. May be called from any thread; where other devices of the GPU used
  // the memory, they must have been waited for.
  virtual void Free(void* memory) noexcept = 0;

  // How many bytes can still be allocated; for CPUs no limit is known, and it
  // is the largest number.
  virtual size_t FreeMemory() = 0;
  // The most bytes that all devices of this GPU together have held at a time;
  // 0 for CPUs, where nobody counts, and for a GPU that does not answer.
  virtual size_t PeakMemory() = 0;

  // Stream-ordered copies between memory of the host and of this device: after
  // the device's earlier work and before its later work. Both return when the
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
