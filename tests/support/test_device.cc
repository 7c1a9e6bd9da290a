// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/support/test_device.h"

namespace tsar {

// cuda_tests has its own.
std::unique_ptr<Device> CreateTestDevice(int num_threads) {
  return Device::CreateCpu(num_threads);
}

}  // namespace tsar
