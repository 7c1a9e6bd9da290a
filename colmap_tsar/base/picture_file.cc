// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/picture_file.h"

#include "colmap_tsar/base/error.h"

#include <new>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {

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
  // OpenCV indexes bytes by an int.
  constexpr size_t kMaxBytes = size_t{1} << 31;
  if (bytes.empty() || bytes.size() >= kMaxBytes) {
    return {};
  }
  // The matrix needs a mutable pointer, but decoding only reads.
  const cv::Mat buffer(1,
                       static_cast<int>(bytes.size()),
                       CV_8UC1,
                       const_cast<uint8_t*>(bytes.data()));
  cv::Mat pixels;
  try {
    pixels = cv::imdecode(buffer, mode);
  } catch (const cv::Exception& exception) {
    if (exception.code == cv::Error::StsNoMem) {
      throw std::bad_alloc();
    }
  }
  if (pixels.empty()) {
    // Decoders fail alike for damaged data and exhausted memory. An allocation
    // beyond malloc's own reserve tells them apart.
    constexpr size_t kMoreThanKept = size_t{64} << 20;
    ::operator delete(::operator new(kMoreThanKept));
  }
  return pixels;
}

}  // namespace tsar
