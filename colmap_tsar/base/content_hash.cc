// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/content_hash.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <vector>

namespace tsar {
namespace {

constexpr uint64_t kMultiplier = 0x9E3779B97F4A7C15ull;

// Spreads every bit of the input over all bits of the output.
uint64_t Mix(uint64_t x) {
  x ^= x >> 32;
  x *= 0xD6E8FEB86659FD93ull;
  x ^= x >> 29;
  x *= kMultiplier;
  return x ^ (x >> 32);
}

}  // namespace

void ContentHash::AddBlock(const unsigned char* block) {
  // Four independent chains, so that the multiplications overlap.
  for (int i = 0; i < 4; ++i) {
    uint64_t word;
    std::memcpy(&word, block + 8 * i, sizeof(word));
    lanes_[i] = std::rotl((lanes_[i] ^ word) * kMultiplier, 29);
  }
}

void ContentHash::Update(const void* data, size_t num_bytes) {
  if (num_bytes == 0) {
    // An empty array may have no address, which memcpy must not see.
    return;
  }
  const auto* bytes = static_cast<const unsigned char*>(data);
  num_bytes_ += num_bytes;
  if (num_rest_ > 0) {
    const size_t num_taken = std::min(num_bytes, kBlockSize - num_rest_);
    std::memcpy(rest_ + num_rest_, bytes, num_taken);
    num_rest_ += num_taken;
    bytes += num_taken;
    num_bytes -= num_taken;
    if (num_rest_ < kBlockSize) {
      return;
    }
    AddBlock(rest_);
    num_rest_ = 0;
  }
  for (; num_bytes >= kBlockSize; num_bytes -= kBlockSize) {
    AddBlock(bytes);
    bytes += kBlockSize;
  }
  if (num_bytes > 0) {
    std::memcpy(rest_, bytes, num_bytes);
    num_rest_ = num_bytes;
  }
}

uint64_t ContentHash::Value() const {
  uint64_t value = Mix(num_bytes_);
  for (const uint64_t lane : lanes_) {
    value = Mix(value ^ lane);
  }
  for (size_t i = 0; i < num_rest_; ++i) {
    value = Mix(value ^ rest_[i]);
  }
  return value;
}

uint64_t HashFile(const std::filesystem::path& path) {
  InputFile file(path);
  if (!file) {
    throw Error::File(file.IsMissing() ? ErrorCode::kNotFound : ErrorCode::kIo,
                      path.string(),
                      "cannot be opened (" + file.Reason() + ")",
                      "check that the file exists and may be read");
  }
  ContentHash hash;
  std::vector<char> buffer(size_t{1} << 20);
  while (file) {
    file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hash.Update(buffer.data(), static_cast<size_t>(file.gcount()));
  }
  if (file.bad()) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "reading failed",
                      "check the disk and the file's permissions");
  }
  return hash.Value();
}

}  // namespace tsar
