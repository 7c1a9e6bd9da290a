// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/companion_maps.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/array_files.h"
#include "colmap_tsar/io/png.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

namespace tsar {
namespace {

// T: uint8_t or uint16_t; throws for anything but a gray picture of such
// numbers.
template <typename T>
Image<T> ReadGray(const std::filesystem::path& path) {
  constexpr int kNumBits = 8 * sizeof(T);
  if (!Exists(path)) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "there is no such file",
                      "refine the workspace first");
  }
  const PngError error = [&](const std::string&) {
    return Error::File(ErrorCode::kCorrupt,
                       path.string(),
                       "is not a picture with one channel of " +
                           std::to_string(kNumBits) + " bits",
                       "refine the workspace again");
  };
  const std::vector<uint8_t> bytes = ReadFileBytes(path);
  const std::optional<PngHeader> header = ReadPngHeader(bytes);
  if (!header || !header->is_gray || header->bits_per_channel != kNumBits) {
    throw error("");
  }
  return DecodePng<T>(bytes, error);
}

// The bits of positive infinity, the first half that is not finite.
constexpr uint16_t kFirstNotFinite = 0x7c00;

std::string HeaderOf(int width, int height) {
  return NpyHeader("<f2",
                   std::to_string(height) + ", " + std::to_string(width));
}

Error CorruptSigmaMap(const std::filesystem::path& path,
                      const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a complete sigma map: " + what,
                     "refine the workspace again");
}

}  // namespace

Image<uint8_t> ReadGrayPng(const std::filesystem::path& path) {
  return ReadGray<uint8_t>(path);
}

Image<uint16_t> ReadGray16Png(const std::filesystem::path& path) {
  return ReadGray<uint16_t>(path);
}

void PutSigmaMap(const Image<uint16_t>& halves, AtomicFile* file) {
  const std::string header = HeaderOf(halves.Width(), halves.Height());
  std::ostream& stream = file->Stream();
  stream.write(header.data(), static_cast<std::streamsize>(header.size()));
  stream.write(
      reinterpret_cast<const char*>(halves.Data()),
      static_cast<std::streamsize>(halves.NumPixels() * sizeof(uint16_t)));
}

Image<float> ReadSigmaMap(const std::filesystem::path& path) {
  InputFile file(path);
  if (file.IsMissing()) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "there is no such file",
                      "refine the workspace first");
  }
  if (!file) {
    throw CorruptSigmaMap(path, file.Reason());
  }
  std::string header(kNpyHeaderSize, '\0');
  file.read(header.data(), kNpyHeaderSize);
  int width = 0;
  int height = 0;
  const size_t shape = header.find('(');
  // Nine digits are more than any file can have and fit an int.
  if (!file || shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "(%9d, %9d)", &height, &width) != 2 ||
      width < 1 || height < 1 || header != HeaderOf(width, height)) {
    throw CorruptSigmaMap(path,
                          "it does not begin as an array of half floats with "
                          "two dimensions");
  }
  const uintmax_t num_values =
      (file.Size() - kNpyHeaderSize) / sizeof(uint16_t);
  // A division is used, since the product of two untrusted numbers may
  // overflow.
  if ((file.Size() - kNpyHeaderSize) % sizeof(uint16_t) != 0 ||
      num_values / static_cast<uintmax_t>(width) !=
          static_cast<uintmax_t>(height) ||
      num_values % static_cast<uintmax_t>(width) != 0) {
    throw CorruptSigmaMap(path,
                          "the header says " + std::to_string(width) + " x " +
                              std::to_string(height) + ", the file has " +
                              std::to_string(file.Size()) + " bytes");
  }
  Image<float> sigma(width, height);
  std::vector<uint16_t> row(static_cast<size_t>(width));
  for (int y = 0; y < height; ++y) {
    file.read(reinterpret_cast<char*>(row.data()),
              static_cast<std::streamsize>(row.size() * sizeof(uint16_t)));
    if (!file || std::any_of(row.begin(), row.end(), [](uint16_t bits) {
          return bits >= kFirstNotFinite;
        })) {
      throw CorruptSigmaMap(path, "a value is negative or not finite");
    }
    std::transform(row.begin(), row.end(), &sigma(0, y), &HalfToFloat);
  }
  return sigma;
}

}  // namespace tsar
