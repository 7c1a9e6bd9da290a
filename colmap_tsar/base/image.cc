// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/image.h"

#include <cstdlib>
#include <memory>
#include <new>

#include <sys/mman.h>

namespace tsar {

void* AllocatePixels(size_t num_bytes) {
  void* const pixels = std::malloc(num_bytes);
  if (pixels == nullptr && num_bytes > 0) {
    throw std::bad_alloc();
  }
  constexpr size_t kHugePage = size_t{1} << 21;
  void* page = pixels;
  size_t room = num_bytes;
  if (std::align(kHugePage, kHugePage, page, room) != nullptr) {
    // The huge pages inside; a mere advice, which may be ignored.
    madvise(page, room / kHugePage * kHugePage, MADV_HUGEPAGE);
  }
  return pixels;
}

}  // namespace tsar
