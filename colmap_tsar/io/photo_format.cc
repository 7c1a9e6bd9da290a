// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo_format.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kPngEnd = "\0\0\0\0IEND\xae\x42\x60\x82"sv;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
constexpr std::string_view kJp2Signature = "\0\0\0\x0cjP  \r\n\x87\n"sv;

std::string_view TextOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool IsSpace(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' ||
         c == '\f';
}

// Reads a little-endian number; 0 beyond the end of the bytes.
template <typename T>
T ReadAt(std::span<const uint8_t> bytes, size_t offset) {
  T value = 0;
  if (offset + sizeof(T) <= bytes.size()) {
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
  }
  return value;
}

// The size of an uncompressed image, clamped: headers are untrusted.
uint64_t RasterBytes(uint64_t row_bytes, uint64_t num_rows) {
  constexpr uint64_t kTooMuch = UINT64_MAX / 2;
  return num_rows != 0 && row_bytes > kTooMuch / num_rows
             ? kTooMuch
             : row_bytes * num_rows;
}

uint64_t DeclaredBmpSize(std::span<const uint8_t> head) {
  constexpr uint64_t kFileHeaderSize = 14;
  constexpr uint64_t kOldHeaderSize = 12;
  const uint64_t header_size = ReadAt<uint32_t>(head, kFileHeaderSize);
  const uint64_t min_size =
      kFileHeaderSize + std::max(header_size, kOldHeaderSize);
  if (head.size() < min_size) {
    return min_size;
  }
  const uint64_t begin = ReadAt<uint32_t>(head, 10);
  uint64_t width = ReadAt<uint16_t>(head, 18);
  uint64_t height = ReadAt<uint16_t>(head, 20);
  uint64_t num_bits = ReadAt<uint16_t>(head, 24);
  if (header_size != kOldHeaderSize) {
    width = ReadAt<uint32_t>(head, 18);
    // The height is negative if the first row is the top one.
    height =
        static_cast<uint64_t>(std::abs(int64_t{ReadAt<int32_t>(head, 22)}));
    num_bits = ReadAt<uint16_t>(head, 28);
    const auto compression = ReadAt<uint32_t>(head, 30);
    if (compression == 1 || compression == 2) {
      return begin + ReadAt<uint32_t>(head, 34);
    }
  }
  // Rows are padded to multiples of 4 bytes.
  return begin + RasterBytes((width * num_bits + 31) / 32 * 4, height);
}

// Reads the numbers of PNM, which spaces and comments separate.
class PnmReader {
 public:
  explicit PnmReader(std::span<const uint8_t> bytes) : text_(TextOf(bytes)) {
    Skip(2);  // Magic, such as "P6".
  }

  // Returns -1 unless there is a number followed by another byte.
  int64_t ReadNumber() {
    constexpr size_t kMaxDigits = 10;
    SkipSpace();
    size_t num_digits = 0;
    int64_t number = 0;
    while (num_digits < text_.size() && text_[num_digits] >= '0' &&
           text_[num_digits] <= '9') {
      if (num_digits == kMaxDigits) {
        return -1;
      }
      number = 10 * number + (text_[num_digits++] - '0');
    }
    if (num_digits == 0 || num_digits == text_.size()) {
      return -1;
    }
    Skip(num_digits);
    return number;
  }

  size_t NumLeft() const { return text_.size(); }

 private:
  void Skip(size_t count) {
    text_.remove_prefix(std::min(count, text_.size()));
  }

  void SkipSpace() {
    while (!text_.empty() && (IsSpace(text_[0]) || text_[0] == '#')) {
      Skip(text_[0] == '#' ? text_.find('\n') : 1);
    }
  }

  std::string_view text_;
};

uint64_t DeclaredTiffSize(std::span<const uint8_t> head) {
  const bool is_big_endian = head[0] == 'M';
  const uint8_t version = head[is_big_endian ? 3 : 2];
  constexpr uint8_t kBigTiff = 43;
  if (version == kBigTiff) {
    const auto offset = ReadAt<uint64_t>(head, 8);
    return is_big_endian ? __builtin_bswap64(offset) : offset;
  }
  const auto offset = ReadAt<uint32_t>(head, 4);
  return is_big_endian ? __builtin_bswap32(offset) : offset;
}

struct PnmHeader {
  explicit PnmHeader(std::span<const uint8_t> bytes) : reader(bytes) {
    kind = bytes.size() > 1 ? static_cast<char>(bytes[1]) : '\0';
    width = reader.ReadNumber();
    height = reader.ReadNumber();
    max_value = reader.ReadNumber();
  }

  bool IsWhole() const { return width >= 0 && height >= 0 && max_value >= 0; }
  bool IsText() const { return kind == '2' || kind == '3'; }
  uint64_t NumRowValues() const {
    return static_cast<uint64_t>(width) *
           (kind == '3' || kind == '6' ? 3u : 1u);
  }

  PnmReader reader;
  char kind;
  int64_t width;
  int64_t height;
  int64_t max_value;
};

uint64_t DeclaredPnmSize(std::span<const uint8_t> head) {
  const PnmHeader header(head);
  if (!header.IsWhole() || header.IsText()) {
    return 0;
  }
  // One space ends the header.
  const uint64_t begin = head.size() - header.reader.NumLeft() + 1;
  return begin +
         RasterBytes(header.NumRowValues() * (header.max_value > 255 ? 2 : 1),
                     static_cast<uint64_t>(header.height));
}

}  // namespace

std::optional<PhotoFormat> FormatOf(std::span<const uint8_t> head) {
  // The version of TIFF is 42, that of BigTIFF 43, in either byte order.
  constexpr std::pair<std::string_view, PhotoFormat> kBeginnings[] = {
      {"\xff\xd8\xff"sv, PhotoFormat::kJpeg},
      {"\x89PNG\r\n\x1a\n"sv, PhotoFormat::kPng},
      {"II*\0"sv, PhotoFormat::kTiff},
      {"MM\0*"sv, PhotoFormat::kTiff},
      {"II+\0"sv, PhotoFormat::kTiff},
      {"MM\0+"sv, PhotoFormat::kTiff},
      {"BM"sv, PhotoFormat::kBmp},
      {kJp2Signature, PhotoFormat::kJpeg2000},
      {"\xff\x4f\xff\x51"sv, PhotoFormat::kJpeg2000}};
  const std::string_view text = TextOf(head);
  for (const auto& [beginning, format] : kBeginnings) {
    if (text.starts_with(beginning)) {
      return format;
    }
  }
  if (text.size() >= 12 && text.starts_with("RIFF"sv) &&
      text.substr(8, 4) == "WEBP"sv) {
    return PhotoFormat::kWebp;
  }
  if (text.size() > 2 && text[0] == 'P' && IsSpace(text[2]) &&
      (text[1] == '2' || text[1] == '3' || text[1] == '5' || text[1] == '6')) {
    return PhotoFormat::kPnm;
  }
  return std::nullopt;
}

uint64_t DeclaredSize(PhotoFormat format, std::span<const uint8_t> head) {
  switch (format) {
    case PhotoFormat::kBmp:
      return DeclaredBmpSize(head);
    case PhotoFormat::kPnm:
      return DeclaredPnmSize(head);
    case PhotoFormat::kTiff:
      return DeclaredTiffSize(head);
    case PhotoFormat::kWebp:
      return uint64_t{8} + ReadAt<uint32_t>(head, 4);
    default:
      return 0;
  }
}

bool HasAllNumbers(std::span<const uint8_t> bytes) {
  PnmHeader header(bytes);
  if (!header.IsWhole()) {
    return false;
  }
  if (!header.IsText()) {
    return true;
  }
  uint64_t num_left =
      RasterBytes(header.NumRowValues(), static_cast<uint64_t>(header.height));
  while (num_left > 0 && header.reader.ReadNumber() >= 0) {
    --num_left;
  }
  return num_left == 0;
}

bool EndsInMarker(PhotoFormat format, std::span<const uint8_t> tail) {
  const std::string_view text = TextOf(tail);
  switch (format) {
    case PhotoFormat::kJpeg:
    case PhotoFormat::kJpeg2000:
      return text.ends_with(kJpegEnd);
    case PhotoFormat::kPng:
      return text.ends_with(kPngEnd);
    default:
      return true;
  }
}

bool HasJpeg2000End(std::span<const uint8_t> bytes) {
  const std::string_view text = TextOf(bytes);
  if (!text.starts_with(kJp2Signature)) {
    return text.ends_with(kJpegEnd);
  }
  // The file consists of boxes: length, type and content.
  std::span<const uint8_t> left = bytes;
  while (left.size() >= 8) {
    const auto short_length = __builtin_bswap32(ReadAt<uint32_t>(left, 0));
    // 0: the box extends to the end of the file; 1: the length follows the
    // type.
    const uint64_t length = short_length == 0 ? left.size()
                            : short_length == 1
                                ? __builtin_bswap64(ReadAt<uint64_t>(left, 8))
                                : short_length;
    if (length < 8 || length > left.size()) {
      return false;
    }
    if (TextOf(left).substr(4, 4) == "jp2c"sv) {
      return TextOf(left.first(length)).ends_with(kJpegEnd);
    }
    left = left.subspan(length);
  }
  return false;
}

Error DamagedPhoto(const std::string& name, const std::string& what) {
  return Error::File(
      ErrorCode::kCorrupt,
      name,
      "the image is damaged: " + what,
      "make the workspace again with image_undistorter, from a whole photo");
}

Error UnreadablePhoto(const std::string& name, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     name,
                     "not a readable image: " + what,
                     "make the workspace again with image_undistorter");
}

void RequirePossibleSize(const std::string& name,
                         int64_t width,
                         int64_t height) {
  // A division is used, since the product of two untrusted numbers may
  // overflow.
  if (width > 0 && height > kMaxNumPixels / width) {
    throw Error::File(ErrorCode::kUnsupported,
                      name,
                      "has " + std::to_string(width) + " x " +
                          std::to_string(height) +
                          " pixels, more than the 2^30 that can be worked on",
                      "run image_undistorter with a smaller --max_image_size");
  }
}

}  // namespace tsar
