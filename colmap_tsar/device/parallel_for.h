// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Runs a kernel object over a range on a device. A kernel is a small struct of
// views and numbers with a const TSAR_HD call operator, the single definition
// of its arithmetic. Included by .cu files only: nvcc compiles them for both
// devices, and without CUDA the host compiler compiles them for the CPU.

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/device/device.h"

#ifdef __CUDACC__
#include "colmap_tsar/device/cuda_device.h"
#endif

#include <cstddef>
#include <cstdint>

namespace tsar {

#ifdef __CUDACC__
namespace internal {

// The least number of blocks per multiprocessor of a kernel, its constant
// kMinBlocks if it has one: more blocks leave fewer registers for each thread.
template <typename Kernel>
constexpr int MinBlocks() {
  if constexpr (requires { Kernel::kMinBlocks; }) {
    return Kernel::kMinBlocks;
  } else {
    return 1;
  }
}

constexpr int kThreadsPerBlock = 128;

template <typename Kernel>
__global__ void __launch_bounds__(kThreadsPerBlock, MinBlocks<Kernel>())
    Launch1D(int64_t count, Kernel kernel) {
  const int64_t i = static_cast<int64_t>(blockIdx.x) * blockDim.x + threadIdx.x;
  if (i < count) {
    kernel(i);
  }
}

template <typename Kernel>
__global__ void Launch2D(int width, int height, Kernel kernel) {
  const int x = blockIdx.x * blockDim.x + threadIdx.x;
  const int y = blockIdx.y * blockDim.y + threadIdx.y;
  if (x < width && y < height) {
    kernel(x, y);
  }
}

}  // namespace internal
#endif

// Calls kernel(i) for every i in [0, count); i is an int64_t.
template <typename Kernel>
void ParallelFor(Device& device, int64_t count, const Kernel& kernel) {
  if (count <= 0) {
    return;
  }
#ifdef __CUDACC__
  if (device.IsCuda()) {
    CudaDevice& cuda = static_cast<CudaDevice&>(device);
    cuda.Activate();
    constexpr int kThreads = internal::kThreadsPerBlock;
    internal::
        Launch1D<<<static_cast<unsigned>((count + kThreads - 1) / kThreads),
                   kThreads,
                   0,
                   cuda.Stream()>>>(count, kernel);
    CheckCuda(cudaGetLastError(), "starting a kernel");
    return;
  }
#endif
  device.Threads().Run(count, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      kernel(i);
    }
  });
}

// Calls kernel(x, y) for every pixel of a width x height raster.
template <typename Kernel>
void ParallelFor(Device& device, int width, int height, const Kernel& kernel) {
  if (width <= 0 || height <= 0) {
    return;
  }
#ifdef __CUDACC__
  if (device.IsCuda()) {
    CudaDevice& cuda = static_cast<CudaDevice&>(device);
    cuda.Activate();
    const dim3 threads(32, 4);
    const dim3 blocks((width + threads.x - 1) / threads.x,
                      (height + threads.y - 1) / threads.y);
    internal::Launch2D<<<blocks, threads, 0, cuda.Stream()>>>(
        width, height, kernel);
    CheckCuda(cudaGetLastError(), "starting a kernel");
    return;
  }
#endif
  device.Threads().Run(height, [&](int64_t begin, int64_t end) {
    for (int64_t y = begin; y < end; ++y) {
      for (int x = 0; x < width; ++x) {
        kernel(x, static_cast<int>(y));
      }
    }
  });
}

namespace internal {

template <typename T>
struct FillKernel {
  T* data;
  T value;
  TSAR_HD void operator()(int64_t i) const { data[i] = value; }
};

template <typename T>
struct CopyKernel {
  const T* source;
  T* target;
  TSAR_HD void operator()(int64_t i) const { target[i] = source[i]; }
};

}  // namespace internal

// data[i] = value for i in [0, count).
template <typename T>
void Fill(Device& device, T* data, size_t count, const T& value) {
  ParallelFor(device,
              static_cast<int64_t>(count),
              internal::FillKernel<T>{data, value});
}

// target[i] = source[i] for i in [0, count), both in the device's memory.
template <typename T>
void Copy(Device& device, const T* source, size_t count, T* target) {
  ParallelFor(device,
              static_cast<int64_t>(count),
              internal::CopyKernel<T>{source, target});
}

}  // namespace tsar
