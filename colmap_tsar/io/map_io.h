// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/vector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace tsar {

// COLMAP's raster files: ASCII "W&H&C&", then W*H*C float32, little-endian, one
// channel after the other. Depth maps have C = 1 (z in the camera frame, units
// of the sparse model, 0 = invalid), normal maps C = 3 (unit vectors in the
// camera frame, towards the camera, (0, 0, 0) = invalid).
//
// All readers throw Error: kNotFound where there is no such file, kCorrupt
// where the header is not exactly of this form or the file is not exactly as
// long as the header says. The length is checked before memory is allocated.

struct MapSize {
  int width = 0;
  int height = 0;
  int channels = 0;

  size_t NumPixels() const {
    return static_cast<size_t>(width) * static_cast<size_t>(height);
  }
  size_t NumValues() const {
    return NumPixels() * static_cast<size_t>(channels);
  }
};

// An open map, of which any part can be read: maps of hundreds of megabytes
// then pass through the processor's cache instead of memory. Pixels are indexed
// row by row. The file stays open if its name is replaced.
class MapReader {
 public:
  explicit MapReader(const std::filesystem::path& path);

  const MapSize& Size() const { return size_; }
  // Throws kCorrupt. kind: for the message, as "a depth map".
  void RequireChannels(int channels, const char* kind) const;

  // Reads values of one channel from first_pixel on. Throws kCorrupt if the
  // file has become shorter.
  void Read(int channel, size_t first_pixel, std::span<float> values);

 private:
  void ReadHeader();

  std::filesystem::path path_;
  std::unique_ptr<InputFile> file_;
  MapSize size_;
  size_t header_size_ = 0;
};

// A MapReader that replaces depths that are negative, NaN or infinite by 0.
class DepthMapReader {
 public:
  explicit DepthMapReader(const std::filesystem::path& path);

  const MapSize& Size() const { return reader_.Size(); }
  void Read(size_t first_pixel, std::span<float> depths);
  // The number of NaN and infinite values read.
  int64_t NumNotFinite() const { return num_not_finite_; }

 private:
  MapReader reader_;
  int64_t num_not_finite_ = 0;
};

// A MapReader that replaces normals with a NaN or infinite element by (0, 0,
// 0).
class NormalMapReader {
 public:
  explicit NormalMapReader(const std::filesystem::path& path);

  const MapSize& Size() const { return reader_.Size(); }
  void Read(size_t first_pixel, std::span<Vec3f> normals);
  // The number of normals read that were not finite.
  int64_t NumNotFinite() const { return num_not_finite_; }

 private:
  MapReader reader_;
  std::array<std::vector<float>, 3> channels_;
  int64_t num_not_finite_ = 0;
};

// Calls function(first, count) for consecutive pieces of [0, num_pixels) that
// fit into the processor's cache.
template <typename Function>
void ForEachPiece(size_t num_pixels, const Function& function) {
  constexpr size_t kPiece = size_t{1} << 13;
  for (size_t first = 0; first < num_pixels; first += kPiece) {
    function(first, num_pixels - first < kPiece ? num_pixels - first : kPiece);
  }
}

// Reads only the header, and checks the file's length.
MapSize ReadMapSize(const std::filesystem::path& path);

// Whole maps, as DepthMapReader and NormalMapReader read them.
Image<float> ReadDepthMap(const std::filesystem::path& path);
Image<Vec3f> ReadNormalMap(const std::filesystem::path& path);

// The writers replace the file atomically (see AtomicFile). They reject, with
// kMismatch, maps that break COLMAP's fusion: empty maps and values that are
// not finite.
void WriteDepthMap(const ContainedPath& path, const Image<float>& depth);
void WriteNormalMap(const ContainedPath& path, const Image<Vec3f>& normal);
// values: channel after channel.
void WriteMap(const ContainedPath& path,
              const MapSize& size,
              std::span<const float> values);

// Writers to a file that the caller commits. They return the hash of its
// content, see content_hash.h.
uint64_t PutDepthMap(const Image<float>& depth, AtomicFile* file);
uint64_t PutNormalMap(const Image<Vec3f>& normal, AtomicFile* file);

}  // namespace tsar
