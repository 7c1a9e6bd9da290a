// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/cuda_staging.h"

#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/cuda_check.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace tsar {
namespace {

void* AllocatePinned(size_t num_bytes) {
  void* memory = nullptr;
  const cudaError_t result = cudaMallocHost(&memory, num_bytes);
  if (result == cudaErrorMemoryAllocation) {
    ForgetCudaError();
    throw Error(ErrorCode::kOutOfMemory,
                "main memory: " + std::to_string(num_bytes >> 20) +
                    " MiB could not be pinned for copies to the GPU (" +
                    cudaGetErrorString(result) +
                    "); close other programs, raise the limit of locked "
                    "memory (ulimit -l), or pass " +
                    OptionName("device") + " cpu");
  }
  CheckCuda(result, "pinning main memory");
  return memory;
}

}  // namespace

CudaStaging::CudaStaging() {
  try {
    for (Chunk& chunk : chunks_) {
      chunk.memory = AllocatePinned(kChunkSize);
      CheckCuda(cudaEventCreateWithFlags(&chunk.copied, cudaEventDisableTiming),
                "creating an event");
    }
  } catch (...) {
    Release();
    throw;
  }
}

CudaStaging::~CudaStaging() { Release(); }

void CudaStaging::Release() noexcept {
  for (Chunk& chunk : chunks_) {
    if (chunk.copied != nullptr) {
      cudaEventDestroy(chunk.copied);
    }
    if (chunk.memory != nullptr) {
      cudaFreeHost(chunk.memory);
    }
  }
}

void CudaStaging::Upload(void* target,
                         const void* source,
                         size_t size,
                         cudaStream_t stream) {
  for (size_t begin = 0, i = 0; begin < size; begin += kChunkSize, ++i) {
    Chunk& chunk = chunks_[i % chunks_.size()];
    const size_t part = std::min(kChunkSize, size - begin);
    // An event that was never recorded counts as completed.
    CheckCuda(cudaEventSynchronize(chunk.copied), "an upload");
    std::memcpy(chunk.memory, static_cast<const char*>(source) + begin, part);
    CheckCuda(cudaMemcpyAsync(static_cast<char*>(target) + begin,
                              chunk.memory,
                              part,
                              cudaMemcpyHostToDevice,
                              stream),
              "an upload");
    CheckCuda(cudaEventRecord(chunk.copied, stream), "an upload");
  }
}

void CudaStaging::Download(void* target,
                           const void* source,
                           size_t size,
                           cudaStream_t stream) {
  const size_t num_parts = (size + kChunkSize - 1) / kChunkSize;
  const auto part_size = [&](size_t i) {
    return std::min(kChunkSize, size - i * kChunkSize);
  };
  // The copy of part i is queued before part i - 1 is read.
  for (size_t i = 0; i <= num_parts; ++i) {
    if (i < num_parts) {
      Chunk& chunk = chunks_[i % chunks_.size()];
      CheckCuda(
          cudaMemcpyAsync(chunk.memory,
                          static_cast<const char*>(source) + i * kChunkSize,
                          part_size(i),
                          cudaMemcpyDeviceToHost,
                          stream),
          "a download");
      CheckCuda(cudaEventRecord(chunk.copied, stream), "a download");
    }
    if (i > 0) {
      Chunk& chunk = chunks_[(i - 1) % chunks_.size()];
      CheckCuda(cudaEventSynchronize(chunk.copied), "a computation");
      std::memcpy(static_cast<char*>(target) + (i - 1) * kChunkSize,
                  chunk.memory,
                  part_size(i - 1));
    }
  }
}

}  // namespace tsar
