// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"

#include <cstdint>

namespace tsar {

// Turns nonnegative labels into ones whose segments are 4-connected and have at
// least min_size pixels: in each round, every smaller one joins its largest
// adjacent segment, among equals the one whose first pixel comes first. Labels
// become 0 ... count - 1 in the order of their first pixel. Returns the count.
int MergeFragments(DeviceImage<int>& labels, int min_size, Device& device);

}  // namespace tsar
