// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/dense_maps.h"

#include "colmap_tsar/base/option_name.h"

#include <array>
#include <optional>

namespace tsar {
namespace {

// OpenCV's type codes of matrices of one and of three floats per element.
constexpr int32_t kOneFloat = 5;
constexpr int32_t kThreeFloats = 21;

// The advice of errors: the name of a file does not identify its format.
std::string Advice() {
  return "check " + OptionName("format") + ", or make the file again";
}

struct MatrixHeader {
  size_t num_bytes = 0;
  int32_t rows = 0;
  int32_t columns = 0;
  int channels = 0;
};

// Reads the header with or without a version; nullopt if the file's length does
// not match it.
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

enum Content : uint8_t {
  kHasDepth = 1,
  kHasNormals = 2,
  kHasConfidence = 4,
  kHasViews = 8,
};

template <typename Matrix>
Matrix ReadMatrix(ByteReader* reader) {
  Matrix matrix;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      matrix(row, column) = reader->Read<double>();
    }
  }
  return matrix;
}

struct Header {
  uint8_t content = 0;
  uint32_t width = 0;
  uint32_t height = 0;
  std::string image_name;
};

Header ReadHeader(ByteReader* reader) {
  Header header;
  const auto magic = reader->Read<std::array<char, 2>>();
  header.content = reader->Read<uint8_t>();
  reader->Take(1 + 2 * sizeof(uint32_t));  // Padding, the image's size.
  header.width = reader->Read<uint32_t>();
  header.height = reader->Read<uint32_t>();
  reader->Take(2 * sizeof(float));  // The range of the depths.
  constexpr int kAll = kHasDepth | kHasNormals | kHasConfidence | kHasViews;
  if (magic != std::array<char, 2>{'D', 'R'} || (header.content & ~kAll) != 0) {
    throw reader->Corrupt("not a depth map of OpenMVS");
  }
  const std::span<const uint8_t> text = reader->Take(reader->Read<uint16_t>());
  header.image_name.assign(text.begin(), text.end());
  return header;
}

FloatMap ReadMap(int width, int height, int channels, ByteReader* reader) {
  FloatMap map = {width, height, channels, {}};
  map.values.resize(static_cast<size_t>(width) * static_cast<size_t>(height) *
                    static_cast<size_t>(channels));
  reader->ReadAll<float>(map.values);
  return map;
}

}  // namespace

FloatMap ParseDmb(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name, Advice());
  const auto type = reader.Read<int32_t>();
  FloatMap map;
  map.height = reader.Read<int32_t>();
  map.width = reader.Read<int32_t>();
  map.channels = reader.Read<int32_t>();
  if (type != 1) {
    throw reader.Corrupt("not a .dmb of floats: its type is " +
                         std::to_string(type) + ", not 1");
  }
  map.values.resize(RequireExactLength(
      reader, map.width, map.height, map.channels, sizeof(float)));
  reader.ReadAll<float>(map.values);
  return map;
}

FloatMap ParseApdMap(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name, Advice());
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

Dmap ParseDmap(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name, Advice());
  const Header header = ReadHeader(&reader);
  if ((header.content & kHasDepth) == 0) {
    throw Error::File(ErrorCode::kUnsupported,
                      name,
                      "this file of OpenMVS holds no depth",
                      "run DensifyPointCloud again");
  }
  Dmap dmap;
  dmap.image_name = header.image_name;
  const auto num_ids = reader.Read<uint32_t>();
  if (num_ids > reader.NumLeft() / sizeof(uint32_t)) {
    throw reader.Corrupt("the file is shorter than its content says");
  }
  reader.Take(num_ids * sizeof(uint32_t));
  const auto k = ReadMatrix<Eigen::Matrix3d>(&reader);
  dmap.camera.file = name;
  dmap.camera.rotation = ReadMatrix<Eigen::Matrix3d>(&reader);
  dmap.camera.center = ReadMatrix<Eigen::Vector3d>(&reader);
  SetCalibration(k, &dmap.camera);

  const bool has_normals = (header.content & kHasNormals) != 0;
  // The size in words of four bytes per pixel.
  const int num_words = 1 + (has_normals ? 3 : 0) +
                        ((header.content & kHasConfidence) != 0 ? 1 : 0) +
                        ((header.content & kHasViews) != 0 ? 1 : 0);
  RequireExactLength(
      reader, header.width, header.height, num_words, sizeof(float));
  const auto columns = static_cast<int>(header.width);
  const auto rows = static_cast<int>(header.height);
  dmap.depth = ToDepth(ReadMap(columns, rows, 1, &reader), name);
  if (has_normals) {
    dmap.normal = ToNormals(ReadMap(columns, rows, 3, &reader), name);
  }
  return dmap;
}

std::string ParseDmapImageName(std::span<const uint8_t> bytes,
                               const std::string& name) {
  ByteReader reader(bytes, name, Advice());
  return ReadHeader(&reader).image_name;
}

}  // namespace tsar
