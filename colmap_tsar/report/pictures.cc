// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/pictures.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr int kJpegQuality = 88;

// OpenCV has no read-only matrices; this one is only read.
cv::Mat AsMat(const Image<Rgb>& image) {
  return cv::Mat(
      image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
}

Image<Rgb> ToImage(const cv::Mat& pixels) {
  Image<Rgb> image(pixels.cols, pixels.rows);
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC3, image.Data());
  pixels.copyTo(target);
  return image;
}

}  // namespace

Image<Rgb> FitPicture(const Image<Rgb>& picture,
                      int max_size,
                      Scaling scaling) {
  const int longer = std::max(picture.Width(), picture.Height());
  if (longer <= max_size) {
    return picture;
  }
  const auto scaled = [&](int size) {
    return std::max(1,
                    static_cast<int>(std::lround(static_cast<double>(size) *
                                                 max_size / longer)));
  };
  cv::Mat resized;
  cv::resize(AsMat(picture),
             resized,
             cv::Size(scaled(picture.Width()), scaled(picture.Height())),
             0,
             0,
             scaling == Scaling::kAverage ? cv::INTER_AREA : cv::INTER_NEAREST);
  return ToImage(resized);
}

Image<Rgb> JoinPictures(const std::vector<Image<Rgb>>& pictures) {
  std::vector<cv::Mat> parts;
  std::transform(
      pictures.begin(), pictures.end(), std::back_inserter(parts), AsMat);
  cv::Mat joined;
  cv::hconcat(parts, joined);
  return ToImage(joined);
}

void WriteJpeg(const ContainedPath& path, const Image<Rgb>& image) {
  cv::Mat bgr;
  cv::cvtColor(AsMat(image), bgr, cv::COLOR_RGB2BGR);
  std::vector<uint8_t> bytes;
  if (!cv::imencode(
          ".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality})) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "the picture cannot be encoded as JPEG",
                      "use an OpenCV that was built with JPEG");
  }
  AtomicFile file(path);
  file.Stream().write(reinterpret_cast<const char*>(bytes.data()),
                      static_cast<std::streamsize>(bytes.size()));
  file.Commit();
}

}  // namespace tsar
