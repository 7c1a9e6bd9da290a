// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/float_map.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"

#include <bit>
#include <cmath>

namespace tsar {
namespace {

void RequireChannels(const FloatMap& map,
                     int channels,
                     const char* kind,
                     const std::string& name) {
  if (map.channels != channels) {
    throw Error::File(ErrorCode::kCorrupt,
                      name,
                      std::string(kind) + " has " + std::to_string(channels) +
                          " channel(s), this file has " +
                          std::to_string(map.channels),
                      "check " + OptionName("format") + " and the file's name");
  }
}

}  // namespace

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

std::vector<uint8_t> ReadFileBytes(const std::filesystem::path& path,
                                   size_t max_num_bytes) {
  InputFile file(path);
  file.RequireOpened("file", "check the path");
  return file.ReadBytes(0, max_num_bytes);
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
  return Error::File(ErrorCode::kCorrupt, name_, what, advice_);
}

size_t RequireExactLength(const ByteReader& reader,
                          int64_t width,
                          int64_t height,
                          int64_t channels,
                          size_t num_value_bytes) {
  // The largest side of an image of a sparse model; the products below do not
  // overflow.
  constexpr int64_t kMaxSide = int64_t{1} << 24;
  constexpr int64_t kMaxChannels = 16;
  const std::string size = std::to_string(width) + " x " +
                           std::to_string(height) + " x " +
                           std::to_string(channels);
  if (width < 1 || height < 1 || channels < 1 || width > kMaxSide ||
      height > kMaxSide || channels > kMaxChannels) {
    throw reader.Corrupt("the header says " + size +
                         ", which is no size of a map");
  }
  const auto num_values = static_cast<uint64_t>(width * height * channels);
  if (num_values * num_value_bytes != reader.NumLeft()) {
    throw reader.Corrupt("the header says " + size + ", but " +
                         std::to_string(reader.NumLeft()) + " bytes follow it");
  }
  return num_values;
}

Image<float> ToDepth(const FloatMap& map, const std::string& name) {
  RequireChannels(map, 1, "a depth map", name);
  Image<float> depth(map.width, map.height);
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    const float value = map.values[i];
    depth.Data()[i] = std::isfinite(value) && value > 0.f ? value : 0.f;
  }
  return depth;
}

Image<Vec3f> ToNormals(const FloatMap& map, const std::string& name) {
  RequireChannels(map, 3, "a normal map", name);
  Image<Vec3f> normals(map.width, map.height);
  for (size_t i = 0; i < normals.NumPixels(); ++i) {
    const float* n = &map.values[3 * i];
    if (std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2])) {
      normals.Data()[i] = {n[0], n[1], n[2]};
    }
  }
  return normals;
}

}  // namespace tsar
