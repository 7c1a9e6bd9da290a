// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstddef>

namespace tsar {

// The sums of the values before each one: count + 1 elements, of which the
// first is 0 and the last the sum of all.
Buffer<int> ExclusiveSum(const int* values, size_t count, Device& device);

}  // namespace tsar
