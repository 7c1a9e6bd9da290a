// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/png.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/import/formats/byte_reader.h"
#include "colmap_tsar/import/formats/picture_header.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {

void WritePng(const ContainedPath& path, const Image<Rgb>& image) {
  const cv::Mat rgb(
      image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<uint8_t> bytes;
  if (!cv::imencode(".png", bgr, bytes)) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the picture cannot be encoded as PNG",
                      "use an OpenCV that was built with PNG");
  }
  AtomicFile file(path);
  file.Stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
  file.Commit();
}

Image<uint8_t> ReadGrayPng(const std::filesystem::path& path) {
  if (!Exists(path)) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "there is no such file",
                      "refine the workspace first");
  }
  std::vector<uint8_t> bytes = ReadFileBytes(path);
  cv::Mat pixels;
  try {
    const PngKind kind = CheckPngFrame(bytes, path.string());
    if (kind.num_bits == 8 && kind.is_gray) {
      pixels = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    }
  } catch (const Error&) {
    // The header breaks the format.
  } catch (const cv::Exception&) {
    pixels.release();
  }
  if (pixels.empty() || pixels.type() != CV_8UC1) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "is not a picture with one channel of 8 bits",
                      "refine the workspace again");
  }
  Image<uint8_t> image(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC1, image.Data());
  pixels.copyTo(target);
  return image;
}

}  // namespace tsar
