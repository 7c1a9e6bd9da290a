// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_io.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/parse_number.h"

#include <bit>
#include <istream>
#include <string>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "maps are little-endian and read as they are");

Error CorruptMap(const std::filesystem::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a complete map: " + what,
                     "run patch_match_stereo again for this image");
}

// Reads "123&" and returns 123, or -1 for anything else.
int ReadHeaderNumber(std::istream& stream) {
  char text[12];  // Longer than any int.
  stream.getline(text, sizeof(text), '&');
  if (!stream.good()) {
    return -1;
  }
  const auto length = static_cast<size_t>(stream.gcount() - 1);
  return ParseNumber<int>({text, length}).value_or(-1);
}

template <typename Reader, typename T>
Image<T> ReadMap(const std::filesystem::path& path) {
  Reader reader(path);
  auto map = Image<T>::Uninitialized(reader.Size().width, reader.Size().height);
  ForEachPiece(map.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, {map.Data() + first, count});
  });
  return map;
}

// Writes one map and hashes it on the way.
class MapWriter {
 public:
  MapWriter(const MapSize& size, AtomicFile* file) : file_(file) {
    Require(size.width > 0 && size.height > 0 && size.channels > 0, "empty");
    const std::string header = std::to_string(size.width) + "&" +
                               std::to_string(size.height) + "&" +
                               std::to_string(size.channels) + "&";
    Put(header.data(), header.size());
  }

  void Write(std::span<const float> values) {
    ForEachPiece(values.size(), [&](size_t first, size_t count) {
      const std::span<const float> piece = values.subspan(first, count);
      // A count is vectorized, a bool is not.
      int num_bad = 0;
      for (const float value : piece) {
        num_bad += IsFinite(value) ? 0 : 1;
      }
      Require(num_bad == 0, "not finite");
      Put(piece.data(), piece.size_bytes());
    });
  }

  uint64_t Hash() const { return hash_.Value(); }

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
  ContentHash hash_;
};

}  // namespace

MapReader::MapReader(const std::filesystem::path& path)
    : path_(path), file_(std::make_unique<InputFile>(path)) {
  if (file_->IsNoFile()) {
    throw CorruptMap(path, file_->Reason());
  }
  file_->RequireOpened("map", "run patch_match_stereo for this image");
  ReadHeader();
}

void MapReader::RequireChannels(int channels, const char* kind) const {
  if (size_.channels != channels) {
    throw CorruptMap(path_,
                     std::string(kind) + " has " + std::to_string(channels) +
                         " channel(s), the header says " +
                         std::to_string(size_.channels));
  }
}

void MapReader::Read(int channel, size_t first_pixel, std::span<float> values) {
  const size_t first =
      static_cast<size_t>(channel) * size_.NumPixels() + first_pixel;
  file_->seekg(
      static_cast<std::streamoff>(header_size_ + first * sizeof(float)));
  file_->read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size_bytes()));
  if (!*file_) {
    throw CorruptMap(path_, "reading it failed");
  }
}

void MapReader::ReadHeader() {
  const uintmax_t num_bytes = file_->Size();
  if (num_bytes == 0) {
    throw CorruptMap(path_, "the file is empty");
  }
  size_.width = ReadHeaderNumber(*file_);
  size_.height = ReadHeaderNumber(*file_);
  size_.channels = ReadHeaderNumber(*file_);
  if (!*file_ || size_.width < 1 || size_.height < 1 || size_.channels < 1) {
    throw CorruptMap(path_,
                     "it does not begin with WIDTH&HEIGHT&CHANNELS& in digits");
  }
  header_size_ = static_cast<size_t>(file_->tellg());
  const uintmax_t num_values = (num_bytes - header_size_) / sizeof(float);
  const auto num_pixels = uintmax_t{size_.NumPixels()};
  // Divisions are used, since the product of three untrusted numbers may
  // overflow.
  const bool fits =
      num_values / num_pixels == static_cast<uintmax_t>(size_.channels) &&
      num_values % num_pixels == 0 &&
      (num_bytes - header_size_) % sizeof(float) == 0;
  if (!fits) {
    throw CorruptMap(path_,
                     "the header says " + std::to_string(size_.width) + " x " +
                         std::to_string(size_.height) + " x " +
                         std::to_string(size_.channels) + ", the file has " +
                         std::to_string(num_bytes) + " bytes");
  }
}

DepthMapReader::DepthMapReader(const std::filesystem::path& path)
    : reader_(path) {
  reader_.RequireChannels(1, "a depth map");
}

void DepthMapReader::Read(size_t first_pixel, std::span<float> depths) {
  reader_.Read(0, first_pixel, depths);
  int num_bad = 0;
  for (float& value : depths) {
    const bool is_finite = IsFinite(value);
    num_bad += is_finite ? 0 : 1;
    value = is_finite && value > 0.f ? value : 0.f;
  }
  num_not_finite_ += num_bad;
}

NormalMapReader::NormalMapReader(const std::filesystem::path& path)
    : reader_(path) {
  reader_.RequireChannels(3, "a normal map");
}

void NormalMapReader::Read(size_t first_pixel, std::span<Vec3f> normals) {
  for (size_t c = 0; c < channels_.size(); ++c) {
    channels_[c].resize(normals.size());
    reader_.Read(static_cast<int>(c), first_pixel, channels_[c]);
  }
  int num_bad = 0;
  for (size_t i = 0; i < normals.size(); ++i) {
    const Vec3f n = {channels_[0][i], channels_[1][i], channels_[2][i]};
    const bool is_finite = IsFinite(n.x) && IsFinite(n.y) && IsFinite(n.z);
    normals[i] = is_finite ? n : Vec3f{};
    num_bad += is_finite ? 0 : 1;
  }
  num_not_finite_ += num_bad;
}

MapSize ReadMapSize(const std::filesystem::path& path) {
  return MapReader(path).Size();
}

Image<float> ReadDepthMap(const std::filesystem::path& path) {
  return ReadMap<DepthMapReader, float>(path);
}

Image<Vec3f> ReadNormalMap(const std::filesystem::path& path) {
  return ReadMap<NormalMapReader, Vec3f>(path);
}

uint64_t PutDepthMap(const Image<float>& depth, AtomicFile* file) {
  MapWriter writer({depth.Width(), depth.Height(), 1}, file);
  writer.Write({depth.Data(), depth.NumPixels()});
  return writer.Hash();
}

uint64_t PutNormalMap(const Image<Vec3f>& normal, AtomicFile* file) {
  MapWriter writer({normal.Width(), normal.Height(), 3}, file);
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
  return writer.Hash();
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

void WriteMap(const ContainedPath& path,
              const MapSize& size,
              std::span<const float> values) {
  if (values.size() != size.NumValues()) {
    throw Error(ErrorCode::kMismatch,
                path.string() + ": there are " + std::to_string(values.size()) +
                    " values for a map of " + std::to_string(size.NumValues()) +
                    "; this is a mistake of the program, please report it");
  }
  AtomicFile file(path);
  MapWriter(size, &file).Write(values);
  file.Commit();
}

}  // namespace tsar
