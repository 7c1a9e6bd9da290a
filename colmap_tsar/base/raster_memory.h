// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <utility>

namespace tsar {

// Memory that FreeRasterMemory() gives back. Large blocks lie on huge pages
// where the system has them: a map of 100 MB then costs 50 page faults and not
// 25,000, which would take longer than to copy it. Throws std::bad_alloc. Both
// can be called from any thread.
void* AllocateRasterMemory(size_t num_bytes);
// num_bytes: as it was allocated.
void FreeRasterMemory(void* memory, size_t num_bytes) noexcept;

// As long as one of these lives, large blocks that are given back stay with the
// process for the next ones of their size: the system clears all pages that it
// gives, which takes as long as to fill them. The most that such blocks and
// those in use together take is max_num_bytes; nothing stays beyond that. There
// may be one at a time in a process.
class RasterMemoryReuse {
 public:
  explicit RasterMemoryReuse(size_t max_num_bytes) noexcept;
  ~RasterMemoryReuse();
  RasterMemoryReuse(const RasterMemoryReuse&) = delete;
  RasterMemoryReuse& operator=(const RasterMemoryReuse&) = delete;

  // What stays with the process, unused.
  static size_t NumFreeBytes() noexcept;
};

// Takes the memory of a vector from there, and leaves elements as they are that
// are created without a value.
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
