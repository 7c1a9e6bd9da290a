// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// Replacements of the CUDA functions in a build without CUDA.

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/device/device.h"

namespace tsar {

std::unique_ptr<Device> Device::CreateCuda(int /*gpu_index*/) {
  throw Error(ErrorCode::kDevice,
              "this program was built without CUDA; pass " +
                  OptionName("device") +
                  " cpu, or build it with -DTSAR_CUDA=ON");
}

int Device::NumCudaDevices() { return 0; }

void Device::PrepareCudaDevices(const std::vector<int>& /*gpu_indices*/) {}

}  // namespace tsar
