// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/picture_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <new>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

PictureInput::PictureInput(const std::filesystem::path& path,
                           PictureWords words)
    : name_(path.string()), words_(std::move(words)), file_(path) {
  if (file_.IsMissing()) {
    throw Error::File(ErrorCode::kNotFound,
                      name_,
                      "no such " + words_.noun,
                      AdviceForMissing(path, words_.advice));
  }
  if (!file_) {
    throw Error::File(
        ErrorCode::kIo,
        name_,
        "the " + words_.noun + " cannot be read: " + file_.Reason(),
        "check that it is a file and that you may read it");
  }
  if (Size() == 0) {
    throw Error::File(
        ErrorCode::kCorrupt, name_, "the file is empty", words_.advice);
  }
}

std::vector<uint8_t> PictureInput::ReadHead(uint64_t count) {
  return Read(0, std::min(count, Size()));
}

std::vector<uint8_t> PictureInput::ReadTail(uint64_t count) {
  const uint64_t num_bytes = std::min(count, Size());
  return Read(Size() - num_bytes, num_bytes);
}

std::vector<uint8_t> PictureInput::ReadAll() {
  // OpenCV indexes bytes by an int.
  constexpr uint64_t kMaxBytes = uint64_t{1} << 31;
  if (Size() >= kMaxBytes) {
    throw Error::File(ErrorCode::kUnsupported,
                      name_,
                      "the " + words_.noun + " has 2 GB or more",
                      words_.advice_if_too_large);
  }
  return Read(0, Size());
}

std::vector<uint8_t> PictureInput::Read(uint64_t begin, uint64_t count) {
  std::vector<uint8_t> bytes(count);
  file_.seekg(static_cast<std::streamoff>(begin));
  file_.read(reinterpret_cast<char*>(bytes.data()),
             static_cast<std::streamsize>(count));
  if (!file_) {
    throw Error::File(ErrorCode::kIo,
                      name_,
                      "reading the " + words_.noun + " failed",
                      "check the disk");
  }
  return bytes;
}

void PutPicture(const cv::Mat& pixels,
                const std::string& extension,
                const std::filesystem::path& path,
                AtomicFile* file,
                const std::vector<int>& parameters) {
  std::vector<uint8_t> bytes;
  bool is_encoded = false;
  try {
    is_encoded = cv::imencode(extension, pixels, bytes, parameters);
  } catch (const cv::Exception&) {
    // Reported below.
  }
  if (!is_encoded) {
    // Encoders have no other failure for valid pixels.
    if (cv::haveImageWriter(extension)) {
      throw std::bad_alloc();
    }
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be encoded as " + extension.substr(1),
                      "use an OpenCV that was built with this format");
  }
  file->Stream().write(reinterpret_cast<const char*>(bytes.data()),
                       static_cast<std::streamsize>(bytes.size()));
}

cv::Mat DecodePicture(std::span<const uint8_t> bytes, int mode) {
  // The matrix needs a mutable pointer, but decoding only reads.
  const cv::Mat buffer(1,
                       static_cast<int>(bytes.size()),
                       CV_8UC1,
                       const_cast<uint8_t*>(bytes.data()));
  try {
    return cv::imdecode(buffer, mode);
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) {
      throw std::bad_alloc();
    }
    return {};
  }
}

}  // namespace tsar
