// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <utility>

namespace tsar {

// Allocates memory to be freed by FreeRasterMemory(). Large blocks use huge
// pages if available: a map of 100 MB then costs 50 page faults and not 25,000,
// which would take longer than copying it. Throws std::bad_alloc. Both
// functions are thread-safe.
void* AllocateRasterMemory(size_t num_bytes);
// num_bytes: the allocated size.
void FreeRasterMemory(void* memory, size_t num_bytes) noexcept;

// While an object lives, freed large blocks are kept for the next allocations
// of their size: the system clears new pages, which takes as long as filling
// them. Such blocks and those in use take at most max_num_bytes together. Only
// one object may exist at a time.
class RasterMemoryReuse {
 public:
  explicit RasterMemoryReuse(size_t max_num_bytes) noexcept;
  ~RasterMemoryReuse();
  RasterMemoryReuse(const RasterMemoryReuse&) = delete;
  RasterMemoryReuse& operator=(const RasterMemoryReuse&) = delete;

  // Bytes of unused blocks that are kept.
  static size_t NumFreeBytes() noexcept;
};

// A vector's allocator of raster memory, which leaves elements without a value
// uninitialized.
template <typename T>
struct RasterAllocator {
  using value_type = T;

  RasterAllocator() = default;
  template <typename U>
  RasterAllocator(const RasterAllocator<U>&) {}

  T* allocate(size_t count) {
    return static_cast<T*>(AllocateRasterMemory(count * sizeof(T)));
  }
  void deallocate(T* memory, size_t count) {
    FreeRasterMemory(memory, count * sizeof(T));
  }

  template <typename U>
  void construct(U*) {}
  template <typename U, typename... Arguments>
  void construct(U* element, Arguments&&... arguments) {
    ::new (static_cast<void*>(element))
        U(std::forward<Arguments>(arguments)...);
  }

  friend bool operator==(const RasterAllocator&, const RasterAllocator&) {
    return true;
  }
};

}  // namespace tsar
