// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/picture_file.h"

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kJpegBegin = "\xff\xd8\xff"sv;
constexpr std::string_view kJpegEnd = "\xff\xd9"sv;
constexpr std::string_view kJpeg2000Begin = "\xff\x4f\xff\x51"sv;
constexpr std::string_view kPngBegin = "\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR"sv;
constexpr std::string_view kPngEnd = "IEND\xae\x42\x60\x82"sv;
// How much of a PNG file its header takes, up to the kind of its colors.
constexpr uint64_t kPngHeaderSize = 26;

std::string_view TextOf(std::span<const uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

uint32_t BigEndianAt(std::span<const uint8_t> bytes, size_t offset) {
  return static_cast<uint32_t>(bytes[offset]) << 24 | bytes[offset + 1] << 16 |
         bytes[offset + 2] << 8 | bytes[offset + 3];
}

// Where the compressed data of a JPEG file begin: behind its segments, of which
// that of EXIF may hold another JPEG file.
size_t FindJpegData(std::span<const uint8_t> bytes) {
  constexpr uint8_t kStartOfScan = 0xda;
  size_t position = 2;
  while (position + 4 <= bytes.size() && bytes[position + 1] != kStartOfScan) {
    position += bytes[position + 1] == 0xff
                    ? 1  // Padding.
                    : 2 + (BigEndianAt(bytes, position) & 0xffff);
  }
  return position;
}

// Whether the data of a file have their end, after which there may be more.
// OpenCV decodes JPEG and JPEG 2000 without it, and fills the rest with gray.
bool HasEnd(std::span<const uint8_t> bytes) {
  const std::string_view text = TextOf(bytes);
  if (text.starts_with(kJpegBegin)) {
    return text.find(kJpegEnd, FindJpegData(bytes)) != std::string_view::npos;
  }
  if (text.starts_with(kPngBegin)) {
    return text.find(kPngEnd) != std::string_view::npos;
  }
  const size_t stream = text.substr(0, 4096).find(kJpeg2000Begin);
  return stream == std::string_view::npos ||
         text.find(kJpegEnd, stream) != std::string_view::npos;
}

constexpr const char* kAdvice =
    "make the workspace again with image_undistorter";

// T: Rgb, or uint8_t for gray.
template <typename T>
Image<T> Read(const std::filesystem::path& path) {
  constexpr bool kIsGray = std::is_same_v<T, uint8_t>;
  InputFile file(path);
  file.RequireOpened("image", kAdvice);
  const std::vector<uint8_t> bytes = file.ReadBytes(0, file.Size());
  cv::Mat pixels;
  if (HasEnd(bytes)) {
    pixels = DecodePicture(bytes,
                           (kIsGray ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR) |
                               cv::IMREAD_IGNORE_ORIENTATION);
  }
  if (pixels.empty()) {
    throw Error::File(
        ErrorCode::kCorrupt,
        path.string(),
        bytes.empty() ? "the file is empty"
        : cv::haveImageReader(path.string())
            ? "the image is damaged or breaks off"
            : "not a readable image: OpenCV does not know its format",
        std::string(kAdvice) + ", from a whole photo");
  }
  auto image = Image<T>::Uninitialized(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, pixels.type(), image.Data());
  if (kIsGray) {
    pixels.copyTo(target);
  } else {
    cv::cvtColor(pixels, target, cv::COLOR_BGR2RGB);
  }
  return image;
}

}  // namespace

Image<Rgb> ReadPhoto(const std::filesystem::path& path) {
  return Read<Rgb>(path);
}

Image<uint8_t> ReadGrayPhoto(const std::filesystem::path& path) {
  return Read<uint8_t>(path);
}

bool HasBlackBorder(const Image<Rgb>& photo) {
  constexpr int64_t kMinShare = 100;  // One of so many.
  const auto is_bright = [](const Rgb& color) {
    return color.r != 0 || color.g != 0 || color.b != 0;
  };
  int64_t num_black = 0;
  for (int y = 0; y < photo.Height(); ++y) {
    const std::span<const Rgb> row(&photo(0, y),
                                   static_cast<size_t>(photo.Width()));
    const auto left = std::find_if(row.begin(), row.end(), is_bright);
    const auto right =
        std::find_if(row.rbegin(), std::make_reverse_iterator(left), is_bright);
    num_black += (left - row.begin()) + (right - row.rbegin());
  }
  return num_black > 0 &&
         num_black * kMinShare >= static_cast<int64_t>(photo.NumPixels());
}

void CheckPhotoFile(const std::filesystem::path& path) {
  InputFile file(path);
  file.RequireOpened("image", kAdvice);
  if (!cv::haveImageReader(path.string()) || !EndsInMarker(&file)) {
    // Cameras may append data after the end.
    ReadPhoto(path);
  }
}

std::optional<PngHeader> ReadPngHeader(InputFile* file) {
  constexpr uint8_t kAlpha = 4;
  const std::vector<uint8_t> head = file->ReadBytes(0, kPngHeaderSize);
  if (head.size() < kPngHeaderSize || !TextOf(head).starts_with(kPngBegin)) {
    return std::nullopt;
  }
  const uint8_t color_type = head[25];
  return PngHeader{
      BigEndianAt(head, 16), BigEndianAt(head, 20), (color_type & kAlpha) != 0};
}

bool EndsInMarker(InputFile* file) {
  const std::vector<uint8_t> head = file->ReadBytes(0, kPngBegin.size());
  const uint64_t tail_size = std::min<uint64_t>(file->Size(), kPngEnd.size());
  const std::vector<uint8_t> tail =
      file->ReadBytes(file->Size() - tail_size, tail_size);
  return TextOf(head).starts_with(kJpegBegin)
             ? TextOf(tail).ends_with(kJpegEnd)
             : !TextOf(head).starts_with(kPngBegin) ||
                   TextOf(tail).ends_with(kPngEnd);
}

}  // namespace tsar
