// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/content_hash.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace tsar {

// A file of a header, the options hash, whose length the header has at byte 12,
// and two groups of arrays, with a fingerprint of each group and of the rest.
// Where in the header these are:
struct SignedLayout {
  size_t header_size;
  size_t first_fingerprint;
  size_t second_fingerprint;
  size_t header_fingerprint;  // Of the header up to here, and the options hash.
};

template <typename T>
T ValueAt(const std::vector<uint8_t>& bytes, size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

inline void PutFingerprint(const ContentHash& hash,
                           size_t offset,
                           std::vector<uint8_t>* bytes) {
  const uint64_t value = hash.Value();
  std::memcpy(bytes->data() + offset, &value, sizeof(value));
}

// Makes the fingerprints right, behind which no mutation would get otherwise.
// first_length(bytes): of the first group, as the header's numbers say; where
// these are absurd, any length will do.
template <typename Function>
std::vector<uint8_t> Signed(std::span<const uint8_t> input,
                            const SignedLayout& layout,
                            const Function& first_length) {
  std::vector<uint8_t> bytes(input.begin(), input.end());
  const size_t header_size = layout.header_size;
  if (bytes.size() < header_size ||
      ValueAt<uint32_t>(bytes, 12) > bytes.size() - header_size) {
    return bytes;
  }
  const size_t begin = header_size + ValueAt<uint32_t>(bytes, 12);
  const size_t end = std::min(begin + first_length(bytes), bytes.size());
  ContentHash first;
  first.Update(bytes.data() + begin, end - begin);
  PutFingerprint(first, layout.first_fingerprint, &bytes);
  ContentHash second;
  second.Update(bytes.data() + end, bytes.size() - end);
  PutFingerprint(second, layout.second_fingerprint, &bytes);
  ContentHash header;
  header.Update(bytes.data(), layout.header_fingerprint);
  header.Update(bytes.data() + header_size, begin - header_size);
  PutFingerprint(header, layout.header_fingerprint, &bytes);
  return bytes;
}

}  // namespace tsar
