// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/raster_memory.h"

#include <new>

#include <sys/mman.h>

namespace tsar {
namespace {

constexpr size_t kHugePage = size_t{2} << 20;
// Of smaller blocks too much would be lost by rounding up.
constexpr size_t kMinHugeBlock = 2 * kHugePage;

}  // namespace

void* AllocateRasterMemory(size_t num_bytes) {
  if (num_bytes < kMinHugeBlock) {
    void* memory = std::malloc(num_bytes);
    if (memory == nullptr) {
      throw std::bad_alloc();
    }
    return memory;
  }
  const size_t rounded = (num_bytes + kHugePage - 1) / kHugePage * kHugePage;
  void* memory = std::aligned_alloc(kHugePage, rounded);
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  madvise(memory, rounded, MADV_HUGEPAGE);  // A wish, which may not be heard.
  return memory;
}

}  // namespace tsar
