// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Runs a kernel object over items that are each worth several threads: groups
// of pixels to be summed up, hypotheses to be scored. Included by .cu files
// only, see parallel_for.h.

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

// kSize lanes that work on one item together: a block of threads on a GPU, one
// thread that plays all of them on the CPU. Sums go through the same additions
// in the same order on both, so that they are equal to the last bit. All lanes
// of a team must make the same calls.
template <int kSize>
class Team {
  static_assert(kSize >= 32 && (kSize & (kSize - 1)) == 0);

 public:
  // The sum of what body(i, &sum) adds for all i in [0, count); given to all
  // lanes. Lane k adds up i = k, k + kSize, ...; then the upper half of the
  // lanes is added to the lower one until one is left. Sum is a type whose
  // default value is zero, with operator +=.
  template <typename Sum, typename Body>
  TSAR_HD Sum Accumulate(int count, const Body& body) const {
#ifdef __CUDA_ARCH__
    // Raw memory, because shared variables cannot have constructors.
    __shared__ alignas(Sum) unsigned char memory[kSize * sizeof(Sum)];
    Sum* sums = reinterpret_cast<Sum*>(memory);
    const int lane = static_cast<int>(threadIdx.x);
    Sum own{};
    for (int i = lane; i < count; i += kSize) {
      body(i, &own);
    }
    sums[lane] = own;
    __syncthreads();
    for (int half = kSize / 2; half > 0; half /= 2) {
      if (lane < half) {
        sums[lane] += sums[lane + half];
      }
      __syncthreads();
    }
    const Sum total = sums[0];
    __syncthreads();  // The memory serves the next call.
    return total;
#else
    Sum sums[kSize] = {};
    for (int begin = 0; begin < count; begin += kSize) {
      const int size = count - begin < kSize ? count - begin : kSize;
      for (int lane = 0; lane < size; ++lane) {
        body(begin + lane, &sums[lane]);
      }
    }
    for (int half = kSize / 2; half > 0; half /= 2) {
      for (int lane = 0; lane < half; ++lane) {
        sums[lane] += sums[lane + half];
      }
    }
    return sums[0];
#endif
  }

  // Whether the calling thread is the one that writes the team's result.
  TSAR_HD bool IsLeader() const {
#ifdef __CUDA_ARCH__
    return threadIdx.x == 0;
#else
    return true;
#endif
  }
};

#ifdef __CUDACC__
namespace internal {

template <int kSize, typename Kernel>
__global__ void __launch_bounds__(kSize) LaunchTeams(Kernel kernel) {
  kernel(Team<kSize>(), static_cast<int64_t>(blockIdx.x));
}

}  // namespace internal
#endif

// kernel(team, i) for every i in [0, count), by a team of kSize lanes each.
template <int kSize, typename Kernel>
void ParallelForTeams(Device& device, int64_t count, const Kernel& kernel) {
  if (count <= 0) {
    return;
  }
#ifdef __CUDACC__
  if (device.IsCuda()) {
    CudaDevice& cuda = static_cast<CudaDevice&>(device);
    cuda.Activate();
    internal::LaunchTeams<kSize>
        <<<static_cast<unsigned>(count), kSize, 0, cuda.Stream()>>>(kernel);
    CheckCuda(cudaGetLastError(), "starting a kernel");
    return;
  }
#endif
  device.Threads().Run(count, [&](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) {
      kernel(Team<kSize>(), i);
    }
  });
}

}  // namespace tsar
