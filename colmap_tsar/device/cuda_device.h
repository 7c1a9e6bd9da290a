// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/cuda_staging.h"
#include "colmap_tsar/device/device.h"

#include <cuda_runtime.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace tsar {

// One stream of a GPU, on which all work of this device is queued. Memory comes
// from the GPU's pool, which its devices share. Only files of this folder use
// this type.
class CudaDevice : public Device {
 public:
  explicit CudaDevice(int gpu_index);
  ~CudaDevice() override;

  std::string Name() const override { return name_; }
  cudaStream_t Stream() const { return stream_.get(); }
  // Makes this GPU the calling thread's current one.
  void Activate() const;

  void* Allocate(size_t num_bytes) override;
  void Free(void* memory) noexcept override;
  size_t FreeMemory() override;
  size_t PeakMemory() override;
  void CopyToDevice(void* target, const void* source, size_t size) override;
  void CopyToHost(void* target, const void* source, size_t size) override;
  void Synchronize() override;

 private:
  struct StreamDeleter {
    void operator()(cudaStream_t stream) const noexcept {
      cudaStreamDestroy(stream);
    }
  };

  // An attribute of the pool in bytes; 0 if the GPU does not respond.
  size_t PoolBytes(cudaMemPoolAttr attribute) const noexcept;

  int gpu_index_;
  std::string name_;
  std::unique_ptr<CUstream_st, StreamDeleter> stream_;
  cudaMemPool_t pool_ = nullptr;
  std::optional<CudaStaging> staging_;
};

}  // namespace tsar
