// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/byte_reader.h"

#include <algorithm>
#include <bit>
#include <fstream>
#include <system_error>

namespace tsar {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

std::vector<uint8_t> ReadFileBytes(const std::filesystem::path& path,
                                   size_t max_num_bytes) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) {
    throw Error::File(
        ErrorCode::kNotFound, path.string(), "no such file", "check the path");
  }
  const uintmax_t num_bytes = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  std::vector<uint8_t> bytes(
      error || !file ? 0 : std::min<size_t>(num_bytes, max_num_bytes));
  if (!error) {
    file.read(reinterpret_cast<char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
  }
  if (error || !file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read",
                      "check that it is a file and that you may read it");
  }
  return bytes;
}

std::span<const uint8_t> ByteReader::Take(size_t num_bytes) {
  if (num_bytes > bytes_.size()) {
    throw Corrupt("the file is shorter than its content says");
  }
  const std::span<const uint8_t> taken = bytes_.first(num_bytes);
  bytes_ = bytes_.subspan(num_bytes);
  return taken;
}

Error ByteReader::Corrupt(const std::string& what) const {
  return Error::File(ErrorCode::kCorrupt,
                     name_,
                     what,
                     "check --format, or make the file again");
}

}  // namespace tsar
