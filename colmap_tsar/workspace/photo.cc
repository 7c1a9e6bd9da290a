// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/photo.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/workspace/jpeg.h"
#include "colmap_tsar/workspace/photo_error.h"
#include "colmap_tsar/workspace/photo_format.h"
#include "colmap_tsar/workspace/png_chunks.h"
#include "colmap_tsar/workspace/tiff_strips.h"

#include <algorithm>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

using Bytes = std::vector<uint8_t>;

// An open file of at least one byte.
class PhotoFile {
 public:
  explicit PhotoFile(const std::filesystem::path& path)
      : name_(path.string()), file_(path) {
    constexpr const char* kAdvice =
        "make the workspace again with image_undistorter";
    if (file_.IsMissing()) {
      throw Error::File(ErrorCode::kNotFound, name_, "no such image", kAdvice);
    }
    if (!file_) {
      throw Error::File(ErrorCode::kIo,
                        name_,
                        "the image cannot be read: " + file_.Reason(),
                        "check that it is a file and that you may read it");
    }
    if (file_.Size() == 0) {
      throw Error::File(
          ErrorCode::kCorrupt, name_, "the file is empty", kAdvice);
    }
  }

  const std::string& Name() const { return name_; }
  uint64_t Size() const { return file_.Size(); }

  // The first bytes, or the last ones; fewer where there are no more.
  Bytes ReadHead(uint64_t count) { return Read(0, std::min(count, Size())); }
  Bytes ReadTail(uint64_t count) {
    const uint64_t num_bytes = std::min(count, Size());
    return Read(Size() - num_bytes, num_bytes);
  }

 private:
  Bytes Read(uint64_t begin, uint64_t count) {
    Bytes bytes(count);
    file_.seekg(static_cast<std::streamoff>(begin));
    file_.read(reinterpret_cast<char*>(bytes.data()),
               static_cast<std::streamsize>(count));
    if (!file_) {
      throw Error::File(
          ErrorCode::kIo, name_, "reading the image failed", "check the disk");
    }
    return bytes;
  }

  std::string name_;
  InputFile file_;
};

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

// Throws where it is known that the file is not whole; OpenCV would go on, or
// print an error of its own.
void RequireWhole(PhotoFormat format,
                  const Bytes& bytes,
                  const std::string& name) {
  std::string defect;
  if (format == PhotoFormat::kPng) {
    defect = FindPngDefect(bytes);
  } else if (format == PhotoFormat::kTiff) {
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

cv::Mat DecodeByOpenCv(const Bytes& bytes, int mode, const std::string& name) {
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(bytes, mode | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) {
      throw std::bad_alloc();
    }
    pixels.release();
  }
  if (pixels.empty()) {
    throw UnreadablePhoto(name, "OpenCV cannot decode it");
  }
  return pixels;
}

// mode: cv::IMREAD_COLOR or IMREAD_GRAYSCALE.
cv::Mat DecodeOther(PhotoFormat format,
                    Bytes bytes,
                    int mode,
                    const std::string& name) {
  if (format == PhotoFormat::kJpeg) {
    CheckJpeg(bytes, name);
  } else {
    RequireWhole(format, bytes, name);
  }
  if (format == PhotoFormat::kPng) {
    bytes = KeepCriticalChunks(bytes);
  }
  return DecodeByOpenCv(bytes, mode, name);
}

struct Content {
  Bytes bytes;
  PhotoFormat format;
  // Of the formats that this library decodes itself.
  bool is_plain_jpeg;
};

Content ReadContent(PhotoFile* file) {
  constexpr uint64_t kMaxBytes = uint64_t{1} << 31;
  if (file->Size() >= kMaxBytes) {
    throw Error::File(ErrorCode::kUnsupported,
                      file->Name(),
                      "the image has 2 GB or more",
                      "run image_undistorter with a smaller --max_image_size");
  }
  Content content;
  content.bytes = file->ReadHead(kMaxBytes);
  content.format = RequireFormat(file->Name(), content.bytes);
  content.is_plain_jpeg = content.format == PhotoFormat::kJpeg &&
                          !ReadJpegKind(content.bytes, file->Name()).is_cmyk;
  return content;
}

}  // namespace

Image<Rgb> ReadPhoto(const std::filesystem::path& path) {
  PhotoFile file(path);
  Content content = ReadContent(&file);
  if (content.is_plain_jpeg) {
    return DecodeJpeg(content.bytes, file.Name());
  }
  const cv::Mat pixels = DecodeOther(
      content.format, std::move(content.bytes), cv::IMREAD_COLOR, file.Name());
  static_assert(sizeof(Rgb) == 3);
  auto image = Image<Rgb>::Uninitialized(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC3, image.Data());
  cv::cvtColor(pixels, target, cv::COLOR_BGR2RGB);
  return image;
}

Image<uint8_t> ReadGrayPhoto(const std::filesystem::path& path) {
  PhotoFile file(path);
  Content content = ReadContent(&file);
  if (content.is_plain_jpeg) {
    return DecodeGrayJpeg(content.bytes, file.Name());
  }
  const cv::Mat pixels = DecodeOther(content.format,
                                     std::move(content.bytes),
                                     cv::IMREAD_GRAYSCALE,
                                     file.Name());
  auto image = Image<uint8_t>::Uninitialized(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC1, image.Data());
  pixels.copyTo(target);
  return image;
}

void CheckPhotoFile(const std::filesystem::path& path) {
  // The header of every format fits in, unless there are long comments.
  constexpr uint64_t kHeadBytes = 4096;
  constexpr uint64_t kTailBytes = 16;
  PhotoFile file(path);
  const Bytes head = file.ReadHead(kHeadBytes);
  const PhotoFormat format = RequireFormat(file.Name(), head);
  if (DeclaredSize(format, head) > file.Size() ||
      !EndsInMarker(format, file.ReadTail(kTailBytes))) {
    // Cameras may add something behind the end.
    ReadPhoto(path);
  }
}

}  // namespace tsar
