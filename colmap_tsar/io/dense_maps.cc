// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/dense_maps.h"

#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"

#include <array>
#include <optional>
#include <sstream>
#include <utility>

#include <Eigen/LU>

namespace tsar {
namespace {

// OpenCV's type codes of matrices of one and of three floats per element.
constexpr int32_t kOneFloat = 5;
constexpr int32_t kThreeFloats = 21;

// The advice of errors: the name of a file does not identify its format.
std::string Advice() {
  return "check " + OptionName("format") + ", or make the file again";
}

FloatMap ReadMap(int width, int height, int channels, ByteReader* reader) {
  FloatMap map = {width, height, channels, {}};
  map.values.resize(static_cast<size_t>(width) * static_cast<size_t>(height) *
                    static_cast<size_t>(channels));
  reader->ReadAll<float>(map.values);
  return map;
}

// Reads an OpenCV matrix of APD whose header has this many words; nullopt if
// the file's length does not match it.
std::optional<FloatMap> ReadMatrix(ByteReader reader, int num_words) {
  if (reader.NumLeft() < num_words * sizeof(int32_t)) {
    return std::nullopt;
  }
  reader.Take((num_words - 3) * sizeof(int32_t));
  const auto rows = reader.Read<int32_t>();
  const auto columns = reader.Read<int32_t>();
  const auto type = reader.Read<int32_t>();
  if (type != kOneFloat && type != kThreeFloats) {
    return std::nullopt;
  }
  const int channels = type == kOneFloat ? 1 : 3;
  try {
    RequireExactLength(reader, columns, rows, channels, sizeof(float));
  } catch (const Error&) {
    return std::nullopt;
  }
  return ReadMap(columns, rows, channels, &reader);
}

// What a .dmap file of OpenMVS holds.
enum DmapContent : uint8_t {
  kHasDepth = 1,
  kHasNormals = 2,
  kHasConfidence = 4,
  kHasViews = 8,
};

// The numbers of a matrix, row by row.
Eigen::Matrix3d ReadMatrix3(ByteReader* reader) {
  Eigen::Matrix3d transposed;
  reader->ReadAll<double>({transposed.data(), 9});
  return transposed.transpose();
}

struct DmapHeader {
  uint8_t content = 0;
  uint32_t width = 0;
  uint32_t height = 0;
  std::string image_name;
};

DmapHeader ReadDmapHeader(ByteReader* reader) {
  DmapHeader header;
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

Error CorruptCamera(const std::string& name, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     name,
                     what,
                     "make the file again, or take it away to go without it");
}

// Reads the matrix that follows a word.
template <typename Matrix>
Matrix ReadMatrixAfter(std::istringstream* text,
                       const std::string& word,
                       const std::string& name) {
  std::string read;
  *text >> read;
  bool is_complete = read == word;
  Matrix matrix;
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) {
      const std::optional<double> number = ReadNumber<double>(*text);
      is_complete &= number.has_value();
      matrix(row, column) = number.value_or(0.0);
    }
  }
  if (!is_complete) {
    throw CorruptCamera(name,
                        "not a camera: it has no \"" + word + "\" with " +
                            std::to_string(matrix.size()) + " numbers");
  }
  return matrix;
}

// Sets `camera` from a calibration matrix and checks it. Throws Error kCorrupt,
// naming camera.file, where a value is not finite, a focal length is not
// positive, or the rotation is invalid.
void SetCalibration(const Eigen::Matrix3d& k, StoredCamera* camera) {
  camera->fx = k(0, 0);
  camera->fy = k(1, 1);
  camera->cx = k(0, 2);
  camera->cy = k(1, 2);
  if (!k.allFinite() || !camera->rotation.allFinite() ||
      !camera->center.allFinite()) {
    throw CorruptCamera(camera->file,
                        "the camera has a value that is no number");
  }
  if (camera->fx <= 0.0 || camera->fy <= 0.0) {
    throw CorruptCamera(camera->file,
                        "the camera has a focal length that is not positive");
  }
  const double deviation = (camera->rotation * camera->rotation.transpose() -
                            Eigen::Matrix3d::Identity())
                               .cwiseAbs()
                               .maxCoeff();
  if (deviation > 1e-3 || camera->rotation.determinant() < 0.0) {
    throw CorruptCamera(camera->file, "the camera's rotation is none");
  }
}

}  // namespace

FloatMap ParseDmb(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name, Advice());
  const auto type = reader.Read<int32_t>();
  const auto height = reader.Read<int32_t>();
  const auto width = reader.Read<int32_t>();
  const auto channels = reader.Read<int32_t>();
  if (type != 1) {
    throw reader.Corrupt("not a .dmb of floats: its type is " +
                         std::to_string(type) + ", not 1");
  }
  RequireExactLength(reader, width, height, channels, sizeof(float));
  return ReadMap(width, height, channels, &reader);
}

FloatMap ParseApdMap(std::span<const uint8_t> bytes, const std::string& name) {
  const ByteReader reader(bytes, name, Advice());
  std::optional<FloatMap> with_version = ReadMatrix(reader, 4);
  std::optional<FloatMap> without = ReadMatrix(reader, 3);
  if (with_version.has_value() == without.has_value()) {
    throw reader.Corrupt(
        "not a matrix of floats of the length (" +
        std::to_string(bytes.size()) +
        " bytes) that its header [version] rows columns type says");
  }
  return std::move(with_version ? *with_version : *without);
}

StoredCamera ParseCamFile(std::span<const uint8_t> bytes,
                          const std::string& name) {
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  const auto pose = ReadMatrixAfter<Eigen::Matrix4d>(&text, "extrinsic", name);
  const auto k = ReadMatrixAfter<Eigen::Matrix3d>(&text, "intrinsic", name);
  StoredCamera camera;
  camera.file = name;
  camera.rotation = pose.topLeftCorner<3, 3>();
  camera.center = -camera.rotation.transpose() * pose.topRightCorner<3, 1>();
  SetCalibration(k, &camera);
  return camera;
}

Dmap ParseDmap(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name, Advice());
  const DmapHeader header = ReadDmapHeader(&reader);
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
  const Eigen::Matrix3d k = ReadMatrix3(&reader);
  dmap.camera.file = name;
  dmap.camera.rotation = ReadMatrix3(&reader);
  reader.ReadAll<double>({dmap.camera.center.data(), 3});
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
  return ReadDmapHeader(&reader).image_name;
}

}  // namespace tsar
