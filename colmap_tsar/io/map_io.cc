// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/finite.h"

#include <algorithm>
#include <bit>
#include <span>
#include <string>
#include <utility>

namespace tsar {
namespace {

void SetCount(int64_t* target, int64_t count) {
  if (target != nullptr) {
    *target = count;
  }
}

// Writes one map and hashes it on the way.
class MapWriter {
 public:
  MapWriter(int width, int height, int channels, AtomicFile* file)
      : file_(file),
        num_values_(static_cast<size_t>(width) * static_cast<size_t>(height) *
                    static_cast<size_t>(channels)) {
    written_.samples.reserve(kNumSamples);
    Require(width > 0 && height > 0 && channels > 0, "empty");
    const std::string header = std::to_string(width) + "&" +
                               std::to_string(height) + "&" +
                               std::to_string(channels) + "&";
    Put(header.data(), header.size());
  }

  void Write(std::span<const float> values) {
    ForEachPiece(values.size(), [&](size_t first, size_t count) {
      const std::span<const float> piece = values.subspan(first, count);
      bool is_finite = true;
      for (const float value : piece) {
        is_finite &= IsFinite(value);
      }
      Require(is_finite, "not finite");
      Put(piece.data(), piece.size_bytes());
    });
    num_written_ += values.size();
    for (size_t i = written_.samples.size(); i < kNumSamples; ++i) {
      const size_t position = SamplePosition(i, num_values_);
      if (position >= num_written_) {
        break;
      }
      written_.samples.push_back(std::bit_cast<uint32_t>(
          values[position - (num_written_ - values.size())]));
    }
  }

  // The description of the written map; the file's time is not known yet.
  WrittenMap Written() {
    written_.hash = hash_.Value();
    return std::move(written_);
  }

 private:
  static void Require(bool condition, const char* what) {
    if (!condition) {
      throw Error(ErrorCode::kMismatch,
                  std::string("a map to be written is ") + what +
                      ", which COLMAP's fusion cannot stand; this is a mistake "
                      "of the program, please report it");
    }
  }

  void Put(const void* data, size_t num_bytes) {
    hash_.Update(data, num_bytes);
    file_->Stream().write(static_cast<const char*>(data),
                          static_cast<std::streamsize>(num_bytes));
  }

  AtomicFile* file_;
  const size_t num_values_;
  size_t num_written_ = 0;
  ContentHash hash_;
  WrittenMap written_;
};

}  // namespace

MapSize ReadMapSize(const std::filesystem::path& path) {
  return MapReader(path).Size();
}

Image<float> ReadDepthMap(const std::filesystem::path& path,
                          int64_t* num_not_finite) {
  DepthMapReader reader(path);
  auto depth =
      Image<float>::Uninitialized(reader.Size().width, reader.Size().height);
  ForEachPiece(depth.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, {depth.Data() + first, count});
  });
  SetCount(num_not_finite, reader.NumNotFinite());
  return depth;
}

Image<Vec3f> ReadNormalMap(const std::filesystem::path& path,
                           int64_t* num_not_finite) {
  NormalMapReader reader(path);
  auto normal =
      Image<Vec3f>::Uninitialized(reader.Size().width, reader.Size().height);
  ForEachPiece(normal.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, {normal.Data() + first, count});
  });
  SetCount(num_not_finite, reader.NumNotFinite());
  return normal;
}

PlanarMap ReadPlanarMap(const std::filesystem::path& path) {
  MapReader reader(path);
  PlanarMap map;
  map.width = reader.Size().width;
  map.height = reader.Size().height;
  map.channels = reader.Size().channels;
  map.values.resize(reader.Size().NumPixels() *
                    static_cast<size_t>(map.channels));
  reader.Read(0, 0, map.values);
  return map;
}

WrittenMap PutDepthMap(const Image<float>& depth, AtomicFile* file) {
  MapWriter writer(depth.Width(), depth.Height(), 1, file);
  writer.Write({depth.Data(), depth.NumPixels()});
  return writer.Written();
}

WrittenMap PutNormalMap(const Image<Vec3f>& normal, AtomicFile* file) {
  MapWriter writer(normal.Width(), normal.Height(), 3, file);
  std::vector<float> channel;
  for (float Vec3f::*element : {&Vec3f::x, &Vec3f::y, &Vec3f::z}) {
    ForEachPiece(normal.NumPixels(), [&](size_t first, size_t count) {
      channel.resize(count);
      for (size_t i = 0; i < count; ++i) {
        channel[i] = normal.Data()[first + i].*element;
      }
      writer.Write(channel);
    });
  }
  return writer.Written();
}

WrittenMap PutPlanarMap(const PlanarMap& map, AtomicFile* file) {
  MapWriter writer(map.width, map.height, map.channels, file);
  writer.Write(map.values);
  return writer.Written();
}

void WriteDepthMap(const ContainedPath& path, const Image<float>& depth) {
  AtomicFile file(path);
  PutDepthMap(depth, &file);
  file.Commit();
}

void WriteNormalMap(const ContainedPath& path, const Image<Vec3f>& normal) {
  AtomicFile file(path);
  PutNormalMap(normal, &file);
  file.Commit();
}

void WritePlanarMap(const ContainedPath& path, const PlanarMap& map) {
  const size_t num_values = static_cast<size_t>(map.width) *
                            static_cast<size_t>(map.height) *
                            static_cast<size_t>(map.channels);
  if (map.values.size() != num_values) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the number of values does not fit the map's size",
                      "this is a mistake of the program, please report it");
  }
  AtomicFile file(path);
  PutPlanarMap(map, &file);
  file.Commit();
}

}  // namespace tsar
