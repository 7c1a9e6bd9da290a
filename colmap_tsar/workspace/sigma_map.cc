// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/sigma_map.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/half.h"
#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <string>
#include <vector>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "sigma maps are little-endian and written as they are");

constexpr size_t kHeaderSize = 128;
// Of the larger halves, the first that is not finite.
constexpr uint16_t kFirstNotFinite = 0x7c00;

// Magic, version, length of the text, and the text, which is padded so that the
// array begins at a multiple of 64 bytes.
std::string MakeHeader(int width, int height) {
  std::string header("\x93NUMPY\x01\x00", 8);
  constexpr size_t kTextSize = kHeaderSize - 10;
  header += static_cast<char>(kTextSize);
  header += '\0';
  header += "{'descr': '<f2', 'fortran_order': False, 'shape': (" +
            std::to_string(height) + ", " + std::to_string(width) + "), }";
  header.resize(kHeaderSize - 1, ' ');
  return header + '\n';
}

Error CorruptSigmaMap(const std::filesystem::path& path,
                      const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a complete sigma map: " + what,
                     "refine the workspace again");
}

}  // namespace

void PutSigmaMap(const Image<uint16_t>& halves, AtomicFile* file) {
  const std::string header = MakeHeader(halves.Width(), halves.Height());
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
  std::string header(kHeaderSize, '\0');
  file.read(header.data(), kHeaderSize);
  int width = 0;
  int height = 0;
  const size_t shape = header.find('(');
  // Nine digits are more than any file can have and fit an int.
  if (!file || shape == std::string::npos ||
      std::sscanf(header.c_str() + shape, "(%9d, %9d)", &height, &width) != 2 ||
      width < 1 || height < 1 || header != MakeHeader(width, height)) {
    throw CorruptSigmaMap(path,
                          "it does not begin as an array of half floats with "
                          "two dimensions");
  }
  const uintmax_t num_values = (file.Size() - kHeaderSize) / sizeof(uint16_t);
  // A division, since the product of two hostile numbers may overflow.
  if ((file.Size() - kHeaderSize) % sizeof(uint16_t) != 0 ||
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
