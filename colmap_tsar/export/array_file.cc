// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/export/array_file.h"

#include "colmap_tsar/base/atomic_file.h"

#include <bit>
#include <string>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays are little-endian and written as they are");
static_assert(sizeof(Vec3f) == 3 * sizeof(float));

// Magic, version, length of the text, and the text, which is padded so that the
// array begins at a multiple of 64 bytes.
std::string MakeHeader(const std::string& type, const std::string& shape) {
  constexpr size_t kHeaderSize = 128;
  constexpr size_t kTextBegin = 10;
  std::string header("\x93NUMPY\x01\x00", 8);
  header += static_cast<char>(kHeaderSize - kTextBegin);
  header += '\0';
  header += "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" +
            shape + "), }";
  header.resize(kHeaderSize - 1, ' ');
  return header + '\n';
}

template <typename T>
void Write(const ContainedPath& path,
           const Image<T>& values,
           const std::string& type,
           const std::string& more_sides) {
  const std::string header =
      MakeHeader(type,
                 std::to_string(values.Height()) + ", " +
                     std::to_string(values.Width()) + more_sides);
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream().write(header.data(),
                      static_cast<std::streamsize>(header.size()));
  file.Stream().write(
      reinterpret_cast<const char*>(values.Data()),
      static_cast<std::streamsize>(values.NumPixels() * sizeof(T)));
  file.Commit();
}

}  // namespace

void WriteArray(const ContainedPath& path, const Image<float>& values) {
  Write(path, values, "<f4", "");
}

void WriteArray(const ContainedPath& path, const Image<Vec3f>& values) {
  Write(path, values, "<f4", ", 3");
}

void WriteArray(const ContainedPath& path, const Image<uint8_t>& values) {
  Write(path, values, "|u1", "");
}

void WriteArray(const ContainedPath& path, const Image<uint16_t>& values) {
  Write(path, values, "<u2", "");
}

}  // namespace tsar
