// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/device.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <cuda_runtime.h>

namespace tsar {

// Clears the thread's last error, which would otherwise be attributed to its
// next kernel.
inline void ForgetCudaError() { cudaGetLastError(); }

// Turns the result of a CUDA call into an exception: kOutOfMemory for a failed
// allocation, kDevice for everything else.
inline void CheckCuda(cudaError_t result, const char* what) {
  if (result == cudaSuccess) {
    return;
  }
  ForgetCudaError();
  const std::string reason = cudaGetErrorString(result);
  if (result == cudaErrorMemoryAllocation) {
    throw Error(ErrorCode::kOutOfMemory,
                std::string("GPU memory: ") + what + " failed (" + reason +
                    "); close other programs that use the GPU, use smaller "
                    "maps, or pass " +
                    OptionName("device") + " cpu");
  }
  throw Error(ErrorCode::kDevice,
              std::string("GPU: ") + what + " failed (" + reason +
                  "); check the driver with nvidia-smi, or pass " +
                  OptionName("device") + " cpu");
}

// Copies between ordinary host memory and a GPU through two small pinned
// buffers: while the GPU copies one, the host fills or empties the other.
// Pinning the images themselves would cost more than copying them. Belongs to
// the GPU that is current at its construction; used by one thread at a time.
class CudaStaging {
 public:
  // The size of each buffer: large enough that the launch of a copy is
  // negligible, small enough to fit into the processor's cache.
  static constexpr size_t kChunkSize = size_t{4} << 20;

  // Throws kOutOfMemory if the buffers cannot be pinned, and kDevice.
  CudaStaging();
  ~CudaStaging();
  CudaStaging(const CudaStaging&) = delete;
  CudaStaging& operator=(const CudaStaging&) = delete;

  // Returns when the source may be changed; the last part may still be in
  // transfer, before all work that is queued on the stream later.
  void Upload(void* target,
              const void* source,
              size_t size,
              cudaStream_t stream);
  // Returns when the target is complete.
  void Download(void* target,
                const void* source,
                size_t size,
                cudaStream_t stream);

 private:
  struct Chunk {
    void* memory = nullptr;
    cudaEvent_t copied = nullptr;
  };

  void Release() noexcept;

  std::array<Chunk, 2> chunks_;
};

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
  uint64_t CreateTexture(const float* pixels,
                         int width,
                         int height,
                         int pitch) override;
  void FreeTexture(uint64_t texture) noexcept override;
  void Synchronize() override;

 private:
  struct StreamDeleter {
    void operator()(cudaStream_t stream) const noexcept {
      cudaStreamDestroy(stream);
    }
  };

  void DestroyFreedTextures() noexcept;
  // An attribute of the pool in bytes; 0 if the GPU does not respond.
  size_t PoolBytes(cudaMemPoolAttr attribute) const noexcept;

  int gpu_index_;
  std::string name_;
  std::unique_ptr<CUstream_st, StreamDeleter> stream_;
  cudaMemPool_t pool_ = nullptr;
  std::optional<CudaStaging> staging_;
  std::mutex mutex_;
  // Destroyed when no kernel uses them any more.
  std::vector<uint64_t> freed_textures_;
};

}  // namespace tsar
