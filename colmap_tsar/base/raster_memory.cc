// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/raster_memory.h"

#include <cstdlib>
#include <mutex>
#include <new>

#include <sys/mman.h>

namespace tsar {
namespace {

constexpr size_t kHugePage = size_t{2} << 20;
// Rounding up smaller blocks would waste too much.
constexpr size_t kMinHugeBlock = 2 * kHugePage;

size_t RoundedUp(size_t num_bytes) {
  return (num_bytes + kHugePage - 1) / kHugePage * kHugePage;
}

void* AllocateHugeBlock(size_t num_bytes) noexcept {
  void* memory = std::aligned_alloc(kHugePage, num_bytes);
  if (memory != nullptr) {
    // This is a hint, which the system may ignore.
    madvise(memory, num_bytes, MADV_HUGEPAGE);
  }
  return memory;
}

// The large blocks of the process. The list of free blocks, latest first, is
// stored in the blocks themselves, so that freeing needs no memory.
class HugeBlocks {
 public:
  void* Allocate(size_t num_bytes) noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    void* memory = TakeFree(num_bytes);
    if (memory == nullptr) {
      FreeDownTo(max_num_bytes_ > num_bytes ? max_num_bytes_ - num_bytes : 0);
      memory = AllocateHugeBlock(num_bytes);
      if (memory == nullptr) {
        FreeDownTo(0);
        memory = AllocateHugeBlock(num_bytes);
      }
    }
    num_bytes_in_use_ += memory != nullptr ? num_bytes : 0;
    return memory;
  }

  void Free(void* memory, size_t num_bytes) noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    num_bytes_in_use_ -= num_bytes;
    first_ = ::new (memory) Block{num_bytes, first_};
    num_free_bytes_ += num_bytes;
    FreeDownTo(max_num_bytes_);
  }

  void SetMax(size_t num_bytes) noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    max_num_bytes_ = num_bytes;
    FreeDownTo(num_bytes);
  }

  size_t NumFreeBytes() noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    return num_free_bytes_;
  }

 private:
  struct Block {
    size_t num_bytes;
    Block* next;
  };

  void* TakeFree(size_t num_bytes) noexcept {
    for (Block** link = &first_; *link != nullptr; link = &(*link)->next) {
      if ((*link)->num_bytes == num_bytes) {
        return Unlink(link);
      }
    }
    return nullptr;
  }

  Block* Unlink(Block** link) noexcept {
    Block* const block = *link;
    num_free_bytes_ -= block->num_bytes;
    *link = block->next;
    return block;
  }

  // Returns the longest unused blocks to the system until the rest, with those
  // in use, takes at most num_bytes.
  void FreeDownTo(size_t num_bytes) noexcept {
    while (first_ != nullptr &&
           num_bytes_in_use_ + num_free_bytes_ > num_bytes) {
      Block** last = &first_;
      while ((*last)->next != nullptr) {
        last = &(*last)->next;
      }
      std::free(Unlink(last));
    }
  }

  std::mutex mutex_;
  Block* first_ = nullptr;
  size_t num_free_bytes_ = 0;
  size_t num_bytes_in_use_ = 0;
  size_t max_num_bytes_ = 0;
};

// The object is never destroyed, since static rasters may be freed later.
HugeBlocks& Blocks() noexcept {
  alignas(HugeBlocks) static unsigned char storage[sizeof(HugeBlocks)];
  static HugeBlocks* const blocks = ::new (storage) HugeBlocks;
  return *blocks;
}

}  // namespace

void* AllocateRasterMemory(size_t num_bytes) {
  void* const memory = num_bytes < kMinHugeBlock
                           ? std::malloc(num_bytes)
                           : Blocks().Allocate(RoundedUp(num_bytes));
  if (memory == nullptr) {
    throw std::bad_alloc();
  }
  return memory;
}

void FreeRasterMemory(void* memory, size_t num_bytes) noexcept {
  if (num_bytes < kMinHugeBlock) {
    std::free(memory);
  } else {
    Blocks().Free(memory, RoundedUp(num_bytes));
  }
}

RasterMemoryReuse::RasterMemoryReuse(size_t max_num_bytes) noexcept {
  Blocks().SetMax(max_num_bytes);
}

RasterMemoryReuse::~RasterMemoryReuse() { Blocks().SetMax(0); }

size_t RasterMemoryReuse::NumFreeBytes() noexcept {
  return Blocks().NumFreeBytes();
}

}  // namespace tsar
