// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace tsar {

// The content of a file, or its first max_num_bytes. Throws Error: kNotFound
// (no such file), kIo (it is not a regular file or cannot be read).
std::vector<uint8_t> ReadFileBytes(const std::filesystem::path& path,
                                   size_t max_num_bytes = SIZE_MAX);

// Reads the little-endian values of a file of another program one after the
// other and knows how many bytes are left, so that no count is believed that
// the file cannot hold. All errors are kCorrupt and name the file.
class ByteReader {
 public:
  // name: the file, for messages. The bytes must outlive the reader.
  ByteReader(std::span<const uint8_t> bytes, const std::string& name)
      : bytes_(bytes), name_(name) {}

  size_t NumLeft() const { return bytes_.size(); }

  template <typename T>
  T Read() {
    T value;
    std::memcpy(&value, Take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  // The next num_bytes bytes.
  std::span<const uint8_t> Take(size_t num_bytes);

  // Fills `values`.
  template <typename T>
  void ReadAll(std::span<T> values) {
    if (!values.empty()) {
      std::memcpy(
          values.data(), Take(values.size_bytes()).data(), values.size_bytes());
    }
  }

  // The error that the file's content breaks its format.
  Error Corrupt(const std::string& what) const;

 private:
  std::span<const uint8_t> bytes_;
  std::string name_;
};

}  // namespace tsar
