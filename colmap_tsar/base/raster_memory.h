// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdlib>
#include <utility>

namespace tsar {

// Memory that std::free() gives back. Large blocks lie on huge pages where the
// system has them: a map of 100 MB then costs 50 page faults and not 25,000,
// which would take longer than to copy it. Throws std::bad_alloc.
void* AllocateRasterMemory(size_t num_bytes);

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
  void deallocate(T* memory, size_t /*count*/) { std::free(memory); }

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
