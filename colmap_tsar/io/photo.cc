// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/photo.h"

#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/io/jpeg.h"
#include "colmap_tsar/io/photo_format.h"
#include "colmap_tsar/io/picture_checks.h"
#include "colmap_tsar/io/png.h"

#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

using Bytes = std::vector<uint8_t>;

PictureInput OpenPhoto(const std::filesystem::path& path) {
  return PictureInput(
      path,
      {"image",
       "make the workspace again with image_undistorter",
       "run image_undistorter with a smaller --max_image_size"});
}

PhotoFormat RequireFormat(const std::string& name,
                          std::span<const uint8_t> head) {
  const std::optional<PhotoFormat> format = FormatOf(head);
  if (!format) {
    throw UnreadablePhoto(name,
                          "it is none of JPEG, PNG, TIFF, WebP, BMP, PGM, PPM "
                          "and JPEG 2000");
  }
  return *format;
}

// Throws if the file is known to be incomplete; OpenCV would continue or print
// its own error.
void RequireWhole(PhotoFormat format,
                  const Bytes& bytes,
                  const std::string& name) {
  std::string defect;
  if (format == PhotoFormat::kTiff) {
    defect = FindTiffDefect(bytes);
  } else if (DeclaredSize(format, bytes) > bytes.size() ||
             (format == PhotoFormat::kPnm && !HasAllNumbers(bytes)) ||
             (format == PhotoFormat::kJpeg2000 && !HasJpeg2000End(bytes))) {
    defect = "it breaks off";
  }
  if (!defect.empty()) {
    throw DamagedPhoto(name, defect);
  }
}

// mode: cv::IMREAD_COLOR or IMREAD_GRAYSCALE.
cv::Mat DecodeOther(PhotoFormat format,
                    const Bytes& bytes,
                    int mode,
                    const std::string& name) {
  if (format == PhotoFormat::kJpeg) {
    CheckJpeg(bytes, name);
  } else {
    RequireWhole(format, bytes, name);
  }
  cv::Mat pixels = DecodePicture(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  if (pixels.empty()) {
    throw UnreadablePhoto(name, "OpenCV cannot decode it");
  }
  return pixels;
}

struct Content {
  Bytes bytes;
  PhotoFormat format;
  // The kind, among the formats that this library decodes itself.
  bool is_plain_jpeg;
};

Content ReadContent(PictureInput* file) {
  Content content;
  content.bytes = file->ReadAll();
  content.format = RequireFormat(file->Name(), content.bytes);
  content.is_plain_jpeg = content.format == PhotoFormat::kJpeg &&
                          !ReadJpegKind(content.bytes, file->Name()).is_cmyk;
  return content;
}

// T: Rgb, or uint8_t for gray.
template <typename T>
Image<T> Read(const std::filesystem::path& path) {
  constexpr bool kIsGray = std::is_same_v<T, uint8_t>;
  PictureInput file = OpenPhoto(path);
  const Content content = ReadContent(&file);
  if (content.is_plain_jpeg) {
    return DecodeJpeg<T>(content.bytes, file.Name());
  }
  if (content.format == PhotoFormat::kPng) {
    return DecodePng<T>(content.bytes, [&](const std::string& defect) {
      return DamagedPhoto(file.Name(), defect);
    });
  }
  const cv::Mat pixels =
      DecodeOther(content.format,
                  content.bytes,
                  kIsGray ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR,
                  file.Name());
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

bool HasAlpha(const std::filesystem::path& path) {
  PictureInput file = OpenPhoto(path);
  const std::optional<PngHeader> header =
      ReadPngHeader(file.ReadHead(kPngHeadSize));
  return header && header->has_alpha;
}

void CheckPhotoFile(const std::filesystem::path& path) {
  // The head holds the header of every format, unless it has long comments.
  constexpr uint64_t kHeadBytes = 4096;
  PictureInput file = OpenPhoto(path);
  const Bytes head = file.ReadHead(kHeadBytes);
  const PhotoFormat format = RequireFormat(file.Name(), head);
  if (DeclaredSize(format, head) > file.Size() ||
      !EndsInMarker(format, file.ReadTail(kTailBytes))) {
    // Cameras may append data after the end.
    ReadPhoto(path);
  }
}

}  // namespace tsar
