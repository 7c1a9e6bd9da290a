// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/scan.h"

#include "colmap_tsar/device/fill.h"

#ifdef __CUDACC__
#include <cub/device/device_scan.cuh>
#endif

namespace tsar {

Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device) {
  Buffer<int> sums(device, count + 1);
#ifdef __CUDACC__
  if (device.IsCuda()) {
    CudaDevice& cuda = static_cast<CudaDevice&>(device);
    Fill(device, sums.Data(), 1, 0);
    size_t size = 0;
    CheckCuda(cub::DeviceScan::InclusiveSum(nullptr,
                                            size,
                                            values,
                                            sums.Data() + 1,
                                            static_cast<int>(count),
                                            cuda.Stream()),
              "measuring a scan");
    Buffer<unsigned char> scratch(device, size);
    CheckCuda(cub::DeviceScan::InclusiveSum(scratch.Data(),
                                            size,
                                            values,
                                            sums.Data() + 1,
                                            static_cast<int>(count),
                                            cuda.Stream()),
              "a scan");
    return sums;
  }
#endif
  int sum = 0;
  for (size_t i = 0; i < count; ++i) {
    sums.Data()[i] = sum;
    sum += values[i];
  }
  sums.Data()[count] = sum;
  return sums;
}

}  // namespace tsar
