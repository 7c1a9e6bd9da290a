// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"

#include <cuda_runtime.h>

namespace tsar {

// One GPU and the stream on which all its work is queued. Only files of this
// folder and parallel_for.h name this type.
class CudaDevice : public Device {
 public:
  CudaDevice(int gpu_index, int num_threads);
  ~CudaDevice() override;

  std::string Name() const override { return name_; }
  cudaStream_t Stream() const { return stream_; }
  // Makes this GPU the calling thread's current one.
  void Activate() const;

  void* Allocate(size_t num_bytes) override;
  void Free(void* memory) noexcept override;
  void CopyToDevice(void* target, const void* source, size_t size) override;
  void CopyToHost(void* target, const void* source, size_t size) override;
  void Synchronize() override;

 private:
  int gpu_index_;
  std::string name_;
  cudaStream_t stream_ = nullptr;
};

}  // namespace tsar
