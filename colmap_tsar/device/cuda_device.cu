// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/cuda_device.h"

#include "colmap_tsar/base/start_thread.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <numeric>
#include <thread>

namespace tsar {
namespace {

__global__ void ProbeKernel() {}

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

CudaDevice::CudaDevice(int gpu_index)
    : Device(DeviceKind::kCuda, 1), gpu_index_(gpu_index) {
  int count = 0;
  CheckCuda(cudaGetDeviceCount(&count), "looking for GPUs");
  if (gpu_index < 0 || gpu_index >= count) {
    throw Error(ErrorCode::kDevice,
                "GPU " + std::to_string(gpu_index) +
                    " does not exist; this "
                    "machine has " +
                    std::to_string(count) + ", change " +
                    OptionName("gpu_index"));
  }
  Activate();
  cudaDeviceProp properties;
  CheckCuda(cudaGetDeviceProperties(&properties, gpu_index),
            "reading the GPU's properties");
  name_ = properties.name;
  cudaFuncAttributes attributes;
  if (cudaFuncGetAttributes(&attributes, ProbeKernel) != cudaSuccess) {
    ForgetCudaError();
    throw Error(ErrorCode::kDevice,
                name_ + ": this program holds no code for compute capability " +
                    std::to_string(properties.major) + "." +
                    std::to_string(properties.minor) +
                    "; build it with CMAKE_CUDA_ARCHITECTURES=" +
                    std::to_string(properties.major) +
                    std::to_string(properties.minor) + ", or pass " +
                    OptionName("device") + " cpu");
  }
  cudaStream_t stream = nullptr;
  CheckCuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking),
            "creating a stream");
  stream_.reset(stream);
  // The pool keeps freed memory, so that the images after the first one
  // allocate nothing from the driver.
  CheckCuda(cudaDeviceGetDefaultMemPool(&pool_, gpu_index),
            "opening the memory pool");
  uint64_t keep_all = UINT64_MAX;
  CheckCuda(cudaMemPoolSetAttribute(
                pool_, cudaMemPoolAttrReleaseThreshold, &keep_all),
            "configuring the memory pool");
  staging_.emplace();
}

CudaDevice::~CudaDevice() {
  cudaSetDevice(gpu_index_);
  cudaStreamSynchronize(Stream());
  DestroyFreedTextures();
}

void CudaDevice::Activate() const {
  CheckCuda(cudaSetDevice(gpu_index_), "selecting the GPU");
}

void* CudaDevice::Allocate(size_t num_bytes) {
  Activate();
  void* memory = nullptr;
  const std::string what =
      "an allocation of " + std::to_string(num_bytes >> 20) + " MiB";
  CheckCuda(cudaMallocAsync(&memory, num_bytes, Stream()), what.c_str());
  return memory;
}

void CudaDevice::Free(void* memory) noexcept {
  cudaSetDevice(gpu_index_);
  cudaFreeAsync(memory, Stream());
}

size_t CudaDevice::PoolBytes(cudaMemPoolAttr attribute) const noexcept {
  uint64_t num_bytes = 0;
  const bool is_known =
      cudaMemPoolGetAttribute(pool_, attribute, &num_bytes) == cudaSuccess;
  return is_known ? num_bytes : 0;
}

size_t CudaDevice::FreeMemory() {
  Activate();
  size_t num_free = 0;
  size_t num_total = 0;
  CheckCuda(cudaMemGetInfo(&num_free, &num_total), "asking for free memory");
  // Unused memory of the pool counts as free.
  return num_free + PoolBytes(cudaMemPoolAttrReservedMemCurrent) -
         PoolBytes(cudaMemPoolAttrUsedMemCurrent);
}

size_t CudaDevice::PeakMemory() {
  return PoolBytes(cudaMemPoolAttrReservedMemHigh);
}

void CudaDevice::CopyToDevice(void* target, const void* source, size_t size) {
  Activate();
  staging_->Upload(target, source, size, Stream());
}

void CudaDevice::CopyToHost(void* target, const void* source, size_t size) {
  Activate();
  staging_->Download(target, source, size, Stream());
}

uint64_t CudaDevice::CreateTexture(const float* pixels,
                                   int width,
                                   int height,
                                   int pitch) {
  Activate();
  cudaResourceDesc resource = {};
  resource.resType = cudaResourceTypePitch2D;
  resource.res.pitch2D.devPtr = const_cast<float*>(pixels);
  resource.res.pitch2D.desc = cudaCreateChannelDesc<float>();
  resource.res.pitch2D.width = static_cast<size_t>(width);
  resource.res.pitch2D.height = static_cast<size_t>(height);
  resource.res.pitch2D.pitchInBytes = sizeof(float) * pitch;
  cudaTextureDesc sampling = {};
  sampling.addressMode[0] = cudaAddressModeClamp;
  sampling.addressMode[1] = cudaAddressModeClamp;
  sampling.filterMode = cudaFilterModeLinear;
  sampling.readMode = cudaReadModeElementType;
  cudaTextureObject_t texture = 0;
  const std::string what = "a texture of " + std::to_string(width) + " x " +
                           std::to_string(height) + " pixels";
  CheckCuda(cudaCreateTextureObject(&texture, &resource, &sampling, nullptr),
            what.c_str());
  return texture;
}

void CudaDevice::FreeTexture(uint64_t texture) noexcept {
  const std::lock_guard lock(mutex_);
  try {
    freed_textures_.push_back(texture);
  } catch (const std::bad_alloc&) {
    // It stays until the program ends.
  }
}

void CudaDevice::DestroyFreedTextures() noexcept {
  const std::lock_guard lock(mutex_);
  for (const uint64_t texture : freed_textures_) {
    if (cudaDestroyTextureObject(texture) != cudaSuccess) {
      ForgetCudaError();
    }
  }
  freed_textures_.clear();
}

void CudaDevice::Synchronize() {
  Activate();
  CheckCuda(cudaStreamSynchronize(Stream()), "a computation");
  DestroyFreedTextures();
}

std::unique_ptr<Device> Device::CreateCuda(int gpu_index) {
  return std::make_unique<CudaDevice>(gpu_index);
}

int Device::NumCudaDevices() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

void Device::PrepareCudaDevices(const std::vector<int>& gpu_indices) {
  std::vector<int> indices = gpu_indices;
  if (indices.empty()) {
    indices.resize(static_cast<size_t>(NumCudaDevices()));
    std::iota(indices.begin(), indices.end(), 0);
  }
  std::vector<std::jthread> threads;
  threads.reserve(indices.size());
  for (const int gpu_index : indices) {
    threads.push_back(StartThread([gpu_index] {
      if (cudaSetDevice(gpu_index) != cudaSuccess ||
          cudaFree(nullptr) != cudaSuccess) {
        ForgetCudaError();
      }
    }));
  }
}

}  // namespace tsar
