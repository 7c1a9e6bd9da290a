// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Included by .cu files only.

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

namespace internal {
template <typename T>
struct FillKernel {
  T* data;
  T value;
  TSAR_HD void operator()(int64_t i) const { data[i] = value; }
};
}  // namespace internal

// data[i] = value for i in [0, count).
template <typename T>
void Fill(Device& device, T* data, size_t count, const T& value) {
  ParallelFor(device,
              static_cast<int64_t>(count),
              internal::FillKernel<T>{data, value});
}

}  // namespace tsar
