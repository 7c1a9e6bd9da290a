// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cstdint>

namespace tsar {

// Stores min(*address, value) and returns the old value. Safe between the
// threads of the CPU and between those of one GPU; the result does not depend
// on their order.
TSAR_HD inline int AtomicMin(int* address, int value) {
#ifdef __CUDA_ARCH__
  return atomicMin(address, value);
#else
  int current = __atomic_load_n(address, __ATOMIC_RELAXED);
  while (
      value < current &&
      !__atomic_compare_exchange_n(
          address, &current, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return current;
#endif
}

// Adds to *address and returns the old value.
TSAR_HD inline int AtomicAdd(int* address, int value) {
#ifdef __CUDA_ARCH__
  return atomicAdd(address, value);
#else
  return __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
#endif
}

TSAR_HD inline int64_t AtomicAdd(int64_t* address, int64_t value) {
#ifdef __CUDA_ARCH__
  // In two's complement the sum of the unsigned numbers has the same bits.
  return static_cast<int64_t>(
      atomicAdd(reinterpret_cast<unsigned long long*>(address),
                static_cast<unsigned long long>(value)));
#else
  return __atomic_fetch_add(address, value, __ATOMIC_RELAXED);
#endif
}

// Stores max(*address, value) and returns the old value.
TSAR_HD inline uint64_t AtomicMax(uint64_t* address, uint64_t value) {
#ifdef __CUDA_ARCH__
  return atomicMax(reinterpret_cast<unsigned long long*>(address),
                   static_cast<unsigned long long>(value));
#else
  uint64_t current = __atomic_load_n(address, __ATOMIC_RELAXED);
  while (
      value > current &&
      !__atomic_compare_exchange_n(
          address, &current, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return current;
#endif
}

// Reads a value that other threads may be changing.
TSAR_HD inline int AtomicLoad(const int* address) {
#ifdef __CUDA_ARCH__
  return *const_cast<const volatile int*>(address);
#else
  return __atomic_load_n(address, __ATOMIC_RELAXED);
#endif
}

// Writes a value that other threads may be writing, too.
TSAR_HD inline void AtomicStore(uint8_t* address, uint8_t value) {
#ifdef __CUDA_ARCH__
  *address = value;
#else
  __atomic_store_n(address, value, __ATOMIC_RELAXED);
#endif
}

}  // namespace tsar
