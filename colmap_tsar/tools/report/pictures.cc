// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/pictures.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/picture_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr int kJpegQuality = 88;

// OpenCV has no const matrices; this one is only read.
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

void Write(const ContainedPath& path,
           const std::string& extension,
           const Image<Rgb>& image,
           const std::vector<int>& parameters) {
  cv::Mat bgr;
  cv::cvtColor(AsMat(image), bgr, cv::COLOR_RGB2BGR);
  AtomicFile file(path);
  PutPicture(bgr, extension, path, &file, parameters);
  file.Commit();
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

void WriteJpeg(const ContainedPath& path, const Image<Rgb>& image) {
  Write(path, ".jpg", image, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

void WritePng(const ContainedPath& path, const Image<Rgb>& image) {
  Write(path, ".png", image, {});
}

}  // namespace tsar
