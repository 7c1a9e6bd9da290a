// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Included by .cu files only.

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {

namespace internal {
template <typename T>
struct CopyKernel {
  const T* source;
  T* target;
  TSAR_HD void operator()(int64_t i) const { target[i] = source[i]; }
};
}  // namespace internal

// target[i] = source[i] for i in [0, count), both in the device's memory.
template <typename T>
void Copy(Device& device, const T* source, size_t count, T* target) {
  ParallelFor(device,
              static_cast<int64_t>(count),
              internal::CopyKernel<T>{source, target});
}

}  // namespace tsar
