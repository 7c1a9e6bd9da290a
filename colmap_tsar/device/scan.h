// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstddef>
#include <cstdint>

namespace tsar {

// The exclusive prefix sums: element i of the result is values[0] + ... +
// values[i - 1]. It has count + 1 elements, the last of which is the total.
// values: count elements in the device's memory.
Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device);

}  // namespace tsar
