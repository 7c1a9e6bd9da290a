// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/canvas.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

static_assert(sizeof(Rgb) == 3, "an Image<Rgb> is read as 8-bit triples");

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
// Half the height of a capital letter at that scale.
constexpr int kHalfLetter = 5;

}  // namespace

int Canvas::AddStrip(int height) {
  const int top = pixels_.rows;
  const cv::Mat strip(height, width_, CV_8UC3, cv::Scalar::all(255));
  if (pixels_.empty()) {
    pixels_ = strip;
  } else {
    cv::vconcat(pixels_, strip, pixels_);
  }
  return top;
}

void Canvas::Draw(const Image<Rgb>& image,
                  int x,
                  int y,
                  int width,
                  int height,
                  Scaling scaling) {
  // OpenCV has no read-only matrices; this one is only read.
  const cv::Mat source(
      image.Height(), image.Width(), CV_8UC3, const_cast<Rgb*>(image.Data()));
  cv::resize(source,
             pixels_(cv::Rect(x, y, width, height)),
             cv::Size(width, height),
             0,
             0,
             scaling == Scaling::kAverage ? cv::INTER_AREA : cv::INTER_NEAREST);
}

void Canvas::FillBox(int x, int y, int width, int height, const Rgb& color) {
  pixels_(cv::Rect(x, y, width, height)) =
      cv::Scalar(color.r, color.g, color.b);
}

void Canvas::Write(const std::string& text, int x, int y) {
  std::string shown = text;
  std::replace_if(
      shown.begin(),
      shown.end(),
      [](char c) { return c < ' ' || c > '~'; },
      '?');
  cv::putText(pixels_,
              shown,
              {x, y + kHalfLetter},
              kFont,
              kFontScale,
              cv::Scalar::all(0),
              1,
              cv::LINE_AA);
}

Image<Rgb> Canvas::Picture() const {
  Image<Rgb> picture(pixels_.cols, pixels_.rows);
  cv::Mat target(pixels_.rows, pixels_.cols, CV_8UC3, picture.Data());
  pixels_.copyTo(target);
  return picture;
}

}  // namespace tsar
