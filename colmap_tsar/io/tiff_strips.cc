// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/tiff_strips.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include <tiffio.h>
#include <zlib.h>

namespace tsar {
namespace {

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
