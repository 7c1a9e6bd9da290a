// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/low_memory.h"

#include <cstddef>
#include <mutex>
#include <new>

#include <opencv2/imgcodecs.hpp>
#include <sys/mman.h>

namespace tsar {
namespace {

// An exception that passes through C code makes the C library load the stack
// unwinder, and end the program where it cannot.
void LoadUnwinder() {
  std::once_flag flag;
  try {
    std::call_once(flag, [] { throw 0; });
  } catch (int) {
    // As intended.
  }
}

}  // namespace

bool HasMemoryToStart() {
  // Twice the memory that the libraries of OpenCV and CUDA were seen to take.
  constexpr size_t kNumBytes = size_t{32} << 20;
  void* const memory = mmap(nullptr,
                            kNumBytes,
                            PROT_READ | PROT_WRITE,
                            MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE,
                            -1,
                            0);
  if (memory == MAP_FAILED) {
    return false;
  }
  munmap(memory, kNumBytes);
  return true;
}

void PrepareForLowMemory() {
  if (!HasMemoryToStart()) {
    throw std::bad_alloc();
  }
  LoadUnwinder();
  // The first query about an image format registers all formats, for which some
  // builds of OpenCV load another library.
  cv::haveImageWriter(".png");
}

}  // namespace tsar
