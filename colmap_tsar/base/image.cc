// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/image.h"

#include <cstdlib>
#include <new>

#include <sys/mman.h>

namespace tsar {
namespace {

constexpr size_t kHugePage = size_t{1} << 21;

}  // namespace

void* AllocatePixels(size_t num_bytes) {
  const bool is_large = num_bytes >= 2 * kHugePage;
  const size_t num_pages = num_bytes / kHugePage + 1;
  void* pixels = is_large ? std::aligned_alloc(kHugePage, num_pages * kHugePage)
                          : std::malloc(num_bytes);
  if (pixels == nullptr) {
    throw std::bad_alloc();
  }
  if (is_large) {
    // A mere advice: without huge pages, only time is lost.
    madvise(pixels, num_bytes, MADV_HUGEPAGE);
  }
  return pixels;
}

}  // namespace tsar
