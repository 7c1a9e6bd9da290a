// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/picture_checks.h"

#include "colmap_tsar/io/float_map.h"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <tiffio.h>
#include <zlib.h>

namespace tsar {
namespace {

void RequirePossibleSize(const ByteReader& reader,
                         int64_t width,
                         int64_t height,
                         size_t num_file_bytes) {
  constexpr int64_t kMaxSide = int64_t{1} << 24;
  constexpr uint64_t kMaxRatio = 4096;
  constexpr uint64_t kMinPixelBytes = 2;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide ||
      kMinPixelBytes * static_cast<uint64_t>(width * height) / kMaxRatio >
          num_file_bytes) {
    throw reader.Corrupt("the header says " + std::to_string(width) + " x " +
                         std::to_string(height) +
                         " pixels, which the file cannot hold");
  }
}

// Reads a null-terminated text.
std::string ReadText(ByteReader* reader) {
  std::string text;
  for (char c = reader->Read<char>(); c != '\0'; c = reader->Read<char>()) {
    text.push_back(c);
  }
  return text;
}

// The types of EXR attributes of fixed size, with their bytes.
constexpr std::pair<std::string_view, size_t> kExrSizes[] = {
    {"box2i", 16},   {"box2f", 16},    {"chromaticities", 32},
    {"double", 8},   {"envmap", 1},    {"compression", 1},
    {"float", 4},    {"int", 4},       {"deepImageState", 1},
    {"keycode", 28}, {"lineOrder", 1}, {"m33f", 36},
    {"m33d", 72},    {"m44f", 64},     {"m44d", 128},
    {"rational", 8}, {"tiledesc", 9},  {"timecode", 8},
    {"v2i", 8},      {"v2f", 8},       {"v2d", 16},
    {"v3i", 12},     {"v3f", 12},      {"v3d", 24}};

// Reads an attribute's value as OpenEXR does, which allocates memory by the
// counts in it and reads the size of its type whatever the header says: after a
// different size it would find other attributes than CheckExr. The rest is left
// in the reader.
void TakeExrValue(const std::string& type, ByteReader* reader) {
  for (const auto& [known, size] : kExrSizes) {
    if (type == known) {
      reader->Take(size);
      return;
    }
  }
  if (type == "chlist") {
    constexpr size_t kChannelSize = 16;
    while (!ReadText(reader).empty()) {
      reader->Take(kChannelSize);
    }
  } else if (type == "preview") {
    const uint64_t width = reader->Read<uint32_t>();
    const uint64_t height = reader->Read<uint32_t>();
    constexpr uint64_t kMaxSide = 1 << 16;
    if (width > kMaxSide || height > kMaxSide) {
      throw reader->Corrupt("the EXR header has a preview of another size");
    }
    reader->Take(width * height * sizeof(uint32_t));
  } else if (type == "stringvector") {
    while (reader->NumLeft() > 0) {
      reader->Take(reader->Read<uint32_t>());
    }
  } else if (type == "floatvector") {
    reader->Take(reader->NumLeft() / sizeof(float) * sizeof(float));
  } else {
    reader->Take(reader->NumLeft());
  }
}

// An upper bound of the compression ratio of photos, so that a declared size
// beyond what the file can hold allocates no memory.
constexpr double kMaxRatio = 4096.0;

// The file in memory as libtiff reads it, and libtiff's first complaint.
struct Source {
  std::span<const uint8_t> bytes;
  uint64_t position = 0;
  std::string complaint;
};

Source& Of(thandle_t handle) { return *static_cast<Source*>(handle); }

tmsize_t Read(thandle_t handle, void* target, tmsize_t num_bytes) {
  Source& source = Of(handle);
  const uint64_t begin =
      std::min<uint64_t>(source.position, source.bytes.size());
  const uint64_t count = std::min<uint64_t>(static_cast<uint64_t>(num_bytes),
                                            source.bytes.size() - begin);
  if (count > 0) {
    std::memcpy(target, source.bytes.data() + begin, count);
  }
  source.position = begin + count;
  return static_cast<tmsize_t>(count);
}

tmsize_t RefuseWrite(thandle_t, void*, tmsize_t) { return -1; }

toff_t Seek(thandle_t handle, toff_t offset, int origin) {
  Source& source = Of(handle);
  source.position = origin == SEEK_SET   ? offset
                    : origin == SEEK_CUR ? source.position + offset
                                         : source.bytes.size() + offset;
  return source.position;
}

int Close(thandle_t) { return 0; }

toff_t Size(thandle_t handle) { return Of(handle).bytes.size(); }

// Notes the first complaint; the rest of the line, such as the row, is dropped.
void NoteComplaint(void* user_data, const char* format, va_list arguments) {
  std::string& complaint = static_cast<Source*>(user_data)->complaint;
  if (complaint.empty()) {
    char text[200];
    std::vsnprintf(text, sizeof(text), format, arguments);
    complaint = text;
  }
}

// A nonzero result keeps libtiff from printing.
int OnError(TIFF*,
            void* user_data,
            const char*,
            const char* format,
            va_list arguments) {
  NoteComplaint(user_data, format, arguments);
  return 1;
}

// Most warnings concern tags, but those of a JPEG decoder concern pixels.
int OnWarning(TIFF*,
              void* user_data,
              const char* module,
              const char* format,
              va_list arguments) {
  if (module != nullptr && std::strcmp(module, "JPEGLib") == 0) {
    NoteComplaint(user_data, format, arguments);
  }
  return 1;
}

using Tiff = std::unique_ptr<TIFF, decltype(&TIFFClose)>;

Tiff Open(Source* source) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)>
      options(TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), &OnError, source);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), &OnWarning, source);
  // Mode "m" disables memory mapping: the bytes are in memory.
  return Tiff(TIFFClientOpenExt("TIFF",
                                "rm",
                                source,
                                &Read,
                                &RefuseWrite,
                                &Seek,
                                &Close,
                                &Size,
                                nullptr,
                                nullptr,
                                options.get()),
              &TIFFClose);
}

// The strips of a picture, or its tiles.
class Strips {
 public:
  explicit Strips(TIFF* tiff)
      : tiff_(tiff),
        is_tiled_(TIFFIsTiled(tiff) != 0),
        num_(is_tiled_ ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff)),
        num_bytes_(static_cast<uint64_t>(std::max<tmsize_t>(
            0, is_tiled_ ? TIFFTileSize(tiff) : TIFFStripSize(tiff)))) {
    uint16_t compression = COMPRESSION_NONE;
    uint16_t fill_order = FILLORDER_MSB2LSB;
    TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &compression);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_FILLORDER, &fill_order);
    is_deflated_ = (compression == COMPRESSION_ADOBE_DEFLATE ||
                    compression == COMPRESSION_DEFLATE) &&
                   fill_order == FILLORDER_MSB2LSB;
  }

  uint32_t Num() const { return num_; }
  // Bytes of one decoded strip; 0 if the header is invalid.
  uint64_t NumBytes() const { return num_bytes_; }

  bool Decode(uint32_t index, std::vector<uint8_t>* target) const {
    const auto size = static_cast<tmsize_t>(target->size());
    return (is_tiled_ ? TIFFReadEncodedTile(tiff_, index, target->data(), size)
                      : TIFFReadEncodedStrip(
                            tiff_, index, target->data(), size)) >= 0;
  }

  // Whether the Deflate data of a strip are valid, and their decoded size; true
  // for other compressions. libtiff stops when it has enough pixels, before the
  // checksum.
  bool Inflate(uint32_t index,
               std::span<const uint8_t> file,
               std::vector<uint8_t>* target,
               uint64_t* num_decoded) const {
    *num_decoded = 0;
    if (!is_deflated_) {
      return true;
    }
    const uint64_t begin = TIFFGetStrileOffset(tiff_, index);
    const uint64_t count = TIFFGetStrileByteCount(tiff_, index);
    if (begin > file.size() || count > file.size() - begin) {
      return false;
    }
    uLongf num_bytes = target->size();
    const int result =
        uncompress(target->data(), &num_bytes, file.data() + begin, count);
    *num_decoded = num_bytes;
    return result == Z_OK;
  }

 private:
  TIFF* tiff_;
  bool is_tiled_;
  uint32_t num_;
  uint64_t num_bytes_;
  bool is_deflated_ = false;
};

}  // namespace

void CheckExr(std::span<const uint8_t> bytes, const std::string& name) {
  constexpr uint32_t kMagic = 20000630;
  ByteReader reader(bytes, name);
  if (reader.Read<uint32_t>() != kMagic) {
    throw reader.Corrupt("not an EXR file");
  }
  constexpr uint32_t kHasParts = 0x1000;
  const bool has_parts = (reader.Read<uint32_t>() & kHasParts) != 0;
  bool has_size = false;
  // A header ends in an empty name; the headers of several parts end in an
  // empty header.
  for (bool at_start = true;;) {
    const std::string attribute = ReadText(&reader);
    if (attribute.empty()) {
      if (!has_size) {
        throw reader.Corrupt("the EXR header has no dataWindow");
      }
      if (at_start || !has_parts) {
        return;
      }
      at_start = true;
      continue;
    }
    at_start = false;
    const std::string type = ReadText(&reader);
    const std::span<const uint8_t> value = reader.Take(reader.Read<uint32_t>());
    ByteReader rest(value, name);
    TakeExrValue(type, &rest);
    if (rest.NumLeft() > 0) {
      throw reader.Corrupt("the EXR header has an attribute of another size");
    }
    if (attribute == "dataWindow") {
      const auto corners =
          ByteReader(value, name).Read<std::array<int32_t, 4>>();
      RequirePossibleSize(reader,
                          int64_t{corners[2]} - corners[0] + 1,
                          int64_t{corners[3]} - corners[1] + 1,
                          bytes.size());
      has_size = true;
    }
  }
}

std::string FindTiffDefect(std::span<const uint8_t> bytes) {
  Source source{bytes, 0, {}};
  const Tiff tiff = Open(&source);
  if (tiff == nullptr) {
    return source.complaint.empty() ? "it has no header" : source.complaint;
  }
  const Strips strips(tiff.get());
  if (strips.NumBytes() == 0 || strips.Num() == 0 ||
      static_cast<double>(strips.NumBytes()) * strips.Num() >
          kMaxRatio * static_cast<double>(bytes.size())) {
    return "its header says more than the file can hold";
  }
  std::vector<uint8_t> target(strips.NumBytes());
  for (uint32_t i = 0; i < strips.Num(); ++i) {
    uint64_t num_decoded = 0;
    if (!strips.Inflate(i, bytes, &target, &num_decoded)) {
      return "a checksum is wrong";
    }
    // The last strip may be shorter; libtiff knows its size.
    const bool is_whole =
        num_decoded == target.size() || strips.Decode(i, &target);
    if (!source.complaint.empty()) {
      return source.complaint;
    }
    if (!is_whole) {
      return "it cannot be decoded";
    }
  }
  return "";
}

}  // namespace tsar
