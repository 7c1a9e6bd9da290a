// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <string>

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

}  // namespace tsar
