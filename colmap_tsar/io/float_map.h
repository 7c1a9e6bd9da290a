// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

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

// Reads the little-endian values of a file of another program in sequence and
// checks every count against the bytes left. All errors are kCorrupt and name
// the file.
class ByteReader {
 public:
  // name: the file, for messages; advice: appended if its content violates the
  // format. The bytes must outlive the reader.
  ByteReader(std::span<const uint8_t> bytes,
             const std::string& name,
             const std::string& advice = "make the file again")
      : bytes_(bytes), name_(name), advice_(advice) {}

  size_t NumLeft() const { return bytes_.size(); }

  template <typename T>
  T Read() {
    T value;
    std::memcpy(&value, Take(sizeof(T)).data(), sizeof(T));
    return value;
  }

  // Reads the next num_bytes bytes.
  std::span<const uint8_t> Take(size_t num_bytes);

  // Reads all of `values`.
  template <typename T>
  void ReadAll(std::span<T> values) {
    if (!values.empty()) {
      std::memcpy(
          values.data(), Take(values.size_bytes()).data(), values.size_bytes());
    }
  }

  // The error for content that violates the format.
  Error Corrupt(const std::string& what) const;

 private:
  std::span<const uint8_t> bytes_;
  std::string name_;
  std::string advice_;
};

// A raster with interleaved channels, row by row. Values are as in the file,
// including those that are not finite.
struct FloatMap {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> values;  // [(y * width + x) * channels + c]
};

// Returns the number of values of a raster declared as width x height x
// channels, each of num_value_bytes. Throws Error kCorrupt unless `reader`
// holds exactly that many.
size_t RequireExactLength(const ByteReader& reader,
                          int64_t width,
                          int64_t height,
                          int64_t channels,
                          size_t num_value_bytes);

// Converts a map of one channel. Values that are negative, NaN or infinite
// become 0, which is "no depth". Throws Error kCorrupt with the file for more
// channels.
Image<float> ToDepth(const FloatMap& map, const std::string& name);

// Converts a map of three channels. Normals with an element that is NaN or
// infinite become (0, 0, 0). Throws Error kCorrupt for another number of
// channels.
Image<Vec3f> ToNormals(const FloatMap& map, const std::string& name);

}  // namespace tsar
