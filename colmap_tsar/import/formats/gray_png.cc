// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/gray_png.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/picture_file.h"
#include "colmap_tsar/import/formats/float_map.h"
#include "colmap_tsar/import/formats/picture_header.h"
#include "colmap_tsar/workspace/png_chunks.h"

#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace tsar {
namespace {

template <typename T>
Image<T> ReadGray(const std::filesystem::path& path) {
  constexpr int kNumBits = 8 * sizeof(T);
  if (!Exists(path)) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "there is no such file",
                      "refine the workspace first");
  }
  const std::vector<uint8_t> bytes = ReadFileBytes(path);
  cv::Mat pixels;
  try {
    const PngKind kind = CheckPngFrame(bytes, path.string());
    if (kind.num_bits == kNumBits && kind.is_gray) {
      pixels = DecodePicture(KeepCriticalChunks(bytes), cv::IMREAD_UNCHANGED);
    }
  } catch (const Error&) {
    // It breaks the format.
  }
  if (pixels.empty() || pixels.type() != cv::DataType<T>::type) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "is not a picture with one channel of " +
                          std::to_string(kNumBits) + " bits",
                      "refine the workspace again");
  }
  Image<T> image(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, pixels.type(), image.Data());
  pixels.copyTo(target);
  return image;
}

}  // namespace

Image<uint8_t> ReadGrayPng(const std::filesystem::path& path) {
  return ReadGray<uint8_t>(path);
}

Image<uint16_t> ReadGray16Png(const std::filesystem::path& path) {
  return ReadGray<uint16_t>(path);
}

}  // namespace tsar
