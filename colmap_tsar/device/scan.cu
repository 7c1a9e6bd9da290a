// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/scan.h"

#include "colmap_tsar/device/fill.h"

#ifdef __CUDACC__
#include <cub/device/device_scan.cuh>
#endif

namespace tsar {
namespace {

#ifdef __CUDACC__

// Computes inclusive sums shifted by one element, so that no value is read
// beyond the last.
Buffer<int> ExclusiveSumOnGpu(const int* values, size_t count, Device& device) {
  CudaDevice& cuda = static_cast<CudaDevice&>(device);
  Buffer<int> sums(device, count + 1);
  Fill(device, sums.Data(), 1, 0);
  if (count == 0) {
    return sums;
  }
  const int64_t num_values = static_cast<int64_t>(count);
  size_t num_bytes = 0;
  CheckCuda(cub::DeviceScan::InclusiveSum(nullptr,
                                          num_bytes,
                                          values,
                                          sums.Data() + 1,
                                          num_values,
                                          cuda.Stream()),
            "preparing a prefix sum");
  Buffer<char> scratch(device, num_bytes);
  CheckCuda(cub::DeviceScan::InclusiveSum(scratch.Data(),
                                          num_bytes,
                                          values,
                                          sums.Data() + 1,
                                          num_values,
                                          cuda.Stream()),
            "a prefix sum");
  return sums;
}

#endif

Buffer<int> ExclusiveSumOnCpu(const int* values, size_t count, Device& device) {
  Buffer<int> sums(device, count + 1);
  int sum = 0;
  for (size_t i = 0; i < count; ++i) {
    sums.Data()[i] = sum;
    sum += values[i];
  }
  sums.Data()[count] = sum;
  return sums;
}

}  // namespace

Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device) {
#ifdef __CUDACC__
  if (device.IsCuda()) {
    return ExclusiveSumOnGpu(values, count, device);
  }
#endif
  return ExclusiveSumOnCpu(values, count, device);
}

}  // namespace tsar
