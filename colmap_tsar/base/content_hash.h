// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <xxhash.h>

namespace tsar {

// The name of the hash function, stored in files that hold hashes: hashes of
// different functions are not comparable.
inline constexpr const char* kContentHashName = "xxh3";

// A 64-bit hash of a sequence of bytes (XXH3), to recognize files that this
// program wrote. It is not cryptographic. The value depends only on the bytes,
// not on how they were split over the calls of Update().
class ContentHash {
 public:
  ContentHash();

  void Update(const void* data, size_t num_bytes);
  uint64_t Value() const;

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

// The hash of a file's content. Throws kNotFound or kIo if it cannot be read.
uint64_t HashFile(const std::filesystem::path& path);

// The 16 hexadecimal digits of a hash.
std::string HexDigits(uint64_t hash);

// The 32-bit FNV-1a hash of an image's name, which keys its random numbers, so
// that they depend neither on the other images nor on their order.
uint32_t HashImageName(const std::string& name);

}  // namespace tsar
