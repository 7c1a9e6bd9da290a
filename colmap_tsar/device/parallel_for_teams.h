// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Runs a kernel object over items that take several threads each, such as sums
// over groups of pixels or scores of hypotheses. Included by .cu files only,
// see parallel_for.h.

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

// kSize lanes that process one item together: a block of threads on a GPU, one
// thread that emulates all lanes on the CPU. Sums take the same additions in
// the same order on both, so that they are bit-identical. All lanes of a team
// must make the same calls.
template <int kSize>
class Team {
  static_assert(kSize >= 32 && (kSize & (kSize - 1)) == 0);

 public:
  // The sum of body(i, &sum) over all i in [0, count), returned to all lanes.
  // Lane k adds up i = k, k + kSize, ...; then the upper half of the lanes is
  // added to the lower one until one is left. Sum is a type whose default value
  // is zero, with operator +=.
  template <typename Sum, typename Body>
  TSAR_HD Sum Accumulate(int count, const Body& body) const {
#ifdef __CUDA_ARCH__
    // Shared variables cannot have constructors, hence raw memory.
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
    __syncthreads();  // The next call reuses the memory.
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

  // Whether the calling thread writes the team's result.
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

// Calls kernel(team, i) for every i in [0, count) by a team of kSize lanes.
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
