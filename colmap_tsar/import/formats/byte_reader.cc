// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/byte_reader.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"

#include <algorithm>
#include <bit>
#include <string>

namespace tsar {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

std::vector<uint8_t> ReadFileBytes(const std::filesystem::path& path,
                                   size_t max_num_bytes) {
  InputFile file(path);
  if (file.IsMissing()) {
    throw Error::File(
        ErrorCode::kNotFound, path.string(), "no such file", "check the path");
  }
  std::vector<uint8_t> bytes(std::min<size_t>(file.Size(), max_num_bytes));
  file.read(reinterpret_cast<char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" +
                          (file.Reason().empty() ? std::string("reading failed")
                                                 : file.Reason()) +
                          ")",
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
  return Error::File(
      ErrorCode::kCorrupt,
      name_,
      what,
      "check " + OptionName("format") + ", or make the file again");
}

}  // namespace tsar
