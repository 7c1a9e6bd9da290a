// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/cuda_device.h"

#include "colmap_tsar/device/cuda_check.h"

#include <cstdint>

namespace tsar {
namespace {

__global__ void ProbeKernel() {}

}  // namespace

CudaDevice::CudaDevice(int gpu_index, int num_threads)
    : Device(DeviceKind::kCuda, num_threads), gpu_index_(gpu_index) {
  int count = 0;
  CheckCuda(cudaGetDeviceCount(&count), "looking for GPUs");
  if (gpu_index < 0 || gpu_index >= count) {
    throw Error(ErrorCode::kDevice,
                "GPU " + std::to_string(gpu_index) + " does not exist; this "
                "machine has " + std::to_string(count) +
                ", change --TsarRefine.gpu_index");
  }
  Activate();
  cudaDeviceProp properties;
  CheckCuda(cudaGetDeviceProperties(&properties, gpu_index),
            "reading the GPU's properties");
  name_ = properties.name;
  cudaFuncAttributes attributes;
  if (cudaFuncGetAttributes(&attributes, ProbeKernel) != cudaSuccess) {
    throw Error(ErrorCode::kDevice,
                name_ + ": this program holds no code for compute capability " +
                    std::to_string(properties.major) + "." +
                    std::to_string(properties.minor) +
                    "; build it with CMAKE_CUDA_ARCHITECTURES=" +
                    std::to_string(properties.major) +
                    std::to_string(properties.minor) +
                    ", or pass --TsarRefine.device cpu");
  }
  CheckCuda(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking),
            "creating a stream");
  // The pool keeps what is freed, so that the images after the first one
  // allocate nothing from the driver.
  cudaMemPool_t pool = nullptr;
  CheckCuda(cudaDeviceGetDefaultMemPool(&pool, gpu_index),
            "opening the memory pool");
  uint64_t keep_all = UINT64_MAX;
  CheckCuda(cudaMemPoolSetAttribute(
                pool, cudaMemPoolAttrReleaseThreshold, &keep_all),
            "configuring the memory pool");
}

CudaDevice::~CudaDevice() {
  cudaSetDevice(gpu_index_);
  cudaStreamSynchronize(stream_);
  cudaStreamDestroy(stream_);
}

void CudaDevice::Activate() const {
  CheckCuda(cudaSetDevice(gpu_index_), "selecting the GPU");
}

void* CudaDevice::Allocate(size_t num_bytes) {
  Activate();
  void* memory = nullptr;
  const std::string what =
      "an allocation of " + std::to_string(num_bytes >> 20) + " MiB";
  CheckCuda(cudaMallocAsync(&memory, num_bytes, stream_), what.c_str());
  return memory;
}

void CudaDevice::Free(void* memory) noexcept {
  cudaSetDevice(gpu_index_);
  cudaFreeAsync(memory, stream_);
}

void CudaDevice::CopyToDevice(void* target, const void* source, size_t size) {
  Activate();
  CheckCuda(
      cudaMemcpyAsync(target, source, size, cudaMemcpyHostToDevice, stream_),
      "an upload");
  Synchronize();
}

void CudaDevice::CopyToHost(void* target, const void* source, size_t size) {
  Activate();
  CheckCuda(
      cudaMemcpyAsync(target, source, size, cudaMemcpyDeviceToHost, stream_),
      "a download");
  Synchronize();
}

void CudaDevice::Synchronize() {
  Activate();
  CheckCuda(cudaStreamSynchronize(stream_), "a computation");
}

std::unique_ptr<Device> Device::CreateCuda(int gpu_index, int num_threads) {
  return std::make_unique<CudaDevice>(gpu_index, num_threads);
}

int Device::NumCudaDevices() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess ? count : 0;
}

}  // namespace tsar
