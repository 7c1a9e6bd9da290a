// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace tsar {

// A 64-bit fingerprint of a sequence of bytes, to recognise files that this
// program wrote. Not for use against an adversary. The value depends only on
// the bytes, not on how they were split over the calls of Update().
class ContentHash {
 public:
  void Update(const void* data, size_t num_bytes);
  uint64_t Value() const;

 private:
  void AddBlock(const unsigned char* block);

  static constexpr size_t kBlockSize = 32;
  uint64_t lanes_[4] = {1, 2, 3, 4};
  unsigned char rest_[kBlockSize] = {};
  size_t num_rest_ = 0;
  uint64_t num_bytes_ = 0;
};

// The fingerprint of a file's content; kNotFound or kIo where it cannot be
// read.
uint64_t HashFile(const std::filesystem::path& path);

}  // namespace tsar
