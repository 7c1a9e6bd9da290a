// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cuda_runtime.h>

#include <array>
#include <cstddef>

namespace tsar {

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

}  // namespace tsar
