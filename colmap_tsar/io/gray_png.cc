// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/gray_png.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/png.h"

#include <optional>
#include <string>
#include <vector>

namespace tsar {
namespace {

// The content of a gray picture of num_bits; throws for any other file.
struct GrayFile {
  GrayFile(const std::filesystem::path& path, int num_bits) {
    if (!Exists(path)) {
      throw Error::File(ErrorCode::kNotFound,
                        path.string(),
                        "there is no such file",
                        "refine the workspace first");
    }
    error = [path, num_bits](const std::string&) {
      return Error::File(ErrorCode::kCorrupt,
                         path.string(),
                         "is not a picture with one channel of " +
                             std::to_string(num_bits) + " bits",
                         "refine the workspace again");
    };
    bytes = ReadFileBytes(path);
    const std::optional<PngHeader> header = ReadPngHeader(bytes);
    if (!header || !header->is_gray || header->bits_per_channel != num_bits) {
      throw error("");
    }
  }

  std::vector<uint8_t> bytes;
  PngError error;
};

}  // namespace

Image<uint8_t> ReadGrayPng(const std::filesystem::path& path) {
  const GrayFile file(path, 8);
  return DecodeGrayPng(file.bytes, file.error);
}

Image<uint16_t> ReadGray16Png(const std::filesystem::path& path) {
  const GrayFile file(path, 16);
  return DecodeGray16Png(file.bytes, file.error);
}

}  // namespace tsar
