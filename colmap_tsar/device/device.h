// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/device/thread_pool.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

enum class DeviceKind { kCpu, kCuda };

// The device on which the loops of the stages run: the threads of the CPU, or
// one stream of a GPU. Work on one device is done in the order of the calls. A
// device is used by one thread at a time; several devices may be used in
// parallel, also several of one GPU, which share its memory: after
// Synchronize(), the others can read the results of one of them.
class Device {
 public:
  virtual ~Device() = default;

  // num_threads < 1 means one thread per core.
  static std::unique_ptr<Device> CreateCpu(int num_threads);

  // The GPU of this index in CUDA's order. Throws kDevice if the program was
  // built without CUDA, there is no such GPU, or the program has no code for
  // it; kOutOfMemory if GPU or main memory does not suffice.
  static std::unique_ptr<Device> CreateCuda(int gpu_index);

  // The number of GPUs that the driver reports; 0 without CUDA or a driver.
  static int NumCudaDevices();

  // Initializes these GPUs, or all if there are none, in parallel, which takes
  // a good part of a second each and would delay the first CreateCuda. Ignores
  // GPUs that fail; CreateCuda reports them.
  static void PrepareCudaDevices(const std::vector<int>& gpu_indices);

  bool IsCuda() const { return kind_ == DeviceKind::kCuda; }
  virtual std::string Name() const = 0;

  // The threads that run a CPU's loops; for a GPU only the calling thread.
  ThreadPool& Threads() { return threads_; }

  // Allocates uninitialized memory that this device's loops can access.
  virtual void* Allocate(size_t num_bytes) = 0;
  // Frees memory after all earlier work of this device. May be called from any
  // thread; other devices of the GPU that used the memory must have been
  // synchronized.
  virtual void Free(void* memory) noexcept = 0;

  // The number of bytes that can still be allocated; the largest number for
  // CPUs.
  virtual size_t FreeMemory() = 0;
  // The peak number of bytes that all devices of this GPU have held together; 0
  // for CPUs and for a GPU that does not respond.
  virtual size_t PeakMemory() = 0;

  // Stream-ordered copies between memory of the host and of this device: after
  // the device's earlier work and before its later work. Both return when the
  // host memory may be changed or read.
  virtual void CopyToDevice(void* target, const void* source, size_t size) = 0;
  virtual void CopyToHost(void* target, const void* source, size_t size) = 0;

  // A texture by which this GPU interpolates a raster in its memory linearly,
  // with its border repeated outside; 0 for CPUs. pixels: aligned to 512 bytes.
  // pitch: from a row to the next, in pixels, a multiple of 8. Throws kDevice
  // if the GPU has no textures of this size.
  virtual uint64_t CreateTexture(const float* /*pixels*/,
                                 int /*width*/,
                                 int /*height*/,
                                 int /*pitch*/) {
    return 0;
  }
  // As Free().
  virtual void FreeTexture(uint64_t /*texture*/) noexcept {}

  // Waits for all queued work. Throws kDevice if any of it failed.
  virtual void Synchronize() = 0;

 protected:
  Device(DeviceKind kind, int num_threads)
      : kind_(kind), threads_(num_threads) {}

 private:
  DeviceKind kind_;
  ThreadPool threads_;
};

// Synchronizes the device at the end of a scope, also after an error, so that
// memory that the device still reads and another device may free outlives the
// scope's work.
class ScopedSynchronization {
 public:
  explicit ScopedSynchronization(Device& device) : device_(device) {}
  ~ScopedSynchronization() {
    try {
      device_.Synchronize();
    } catch (const Error&) {
      // The next use of the device reports the error.
    }
  }
  ScopedSynchronization(const ScopedSynchronization&) = delete;
  ScopedSynchronization& operator=(const ScopedSynchronization&) = delete;

 private:
  Device& device_;
};

}  // namespace tsar
