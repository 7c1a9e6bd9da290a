// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/apd_map.h"

#include <optional>

namespace tsar {
namespace {

// OpenCV's numbers for a matrix of one and of three floats per element.
constexpr int32_t kOneFloat = 5;
constexpr int32_t kThreeFloats = 21;

struct MatrixHeader {
  size_t num_bytes = 0;
  int32_t rows = 0;
  int32_t columns = 0;
  int channels = 0;
};

// The header with or without a version, where the file has its length.
std::optional<MatrixHeader> ReadHeader(std::span<const uint8_t> bytes,
                                       bool has_version) {
  MatrixHeader header;
  header.num_bytes = (has_version ? 4 : 3) * sizeof(int32_t);
  if (bytes.size() < header.num_bytes) {
    return std::nullopt;
  }
  ByteReader reader(bytes, "");
  if (has_version) {
    reader.Read<int32_t>();
  }
  header.rows = reader.Read<int32_t>();
  header.columns = reader.Read<int32_t>();
  const auto type = reader.Read<int32_t>();
  if (type != kOneFloat && type != kThreeFloats) {
    return std::nullopt;
  }
  header.channels = type == kOneFloat ? 1 : 3;
  try {
    RequireExactLength(
        reader, header.columns, header.rows, header.channels, sizeof(float));
  } catch (const Error&) {
    return std::nullopt;
  }
  return header;
}

}  // namespace

FloatMap ParseApdMap(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name);
  const std::optional<MatrixHeader> with_version = ReadHeader(bytes, true);
  const std::optional<MatrixHeader> without = ReadHeader(bytes, false);
  if (with_version.has_value() == without.has_value()) {
    throw reader.Corrupt(
        "not a matrix of floats of the length (" +
        std::to_string(bytes.size()) +
        " bytes) that its header [version] rows columns type says");
  }
  const MatrixHeader header = with_version ? *with_version : *without;
  reader.Take(header.num_bytes);
  FloatMap map;
  map.width = header.columns;
  map.height = header.rows;
  map.channels = header.channels;
  map.values.resize(reader.NumLeft() / sizeof(float));
  reader.ReadAll<float>(map.values);
  return map;
}

}  // namespace tsar
