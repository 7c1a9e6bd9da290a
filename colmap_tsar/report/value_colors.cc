// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/value_colors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

namespace tsar {

Image<Rgb> ColorizeValues(const Image<float>& values,
                          float max,
                          const Image<float>* mask) {
  cv::Mat codes(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) {
    codes.at<uint8_t>(0, i) = static_cast<uint8_t>(i);
  }
  cv::Mat scale;
  cv::applyColorMap(codes, scale, cv::COLORMAP_VIRIDIS);
  Image<Rgb> colors(values.Width(), values.Height());
  for (size_t i = 0; i < values.NumPixels(); ++i) {
    if (mask != nullptr && mask->Data()[i] == 0.f) {
      continue;
    }
    // Not a number counts as 0.
    const float share = std::max(0.f, std::min(values.Data()[i] / max, 1.f));
    const auto& bgr =
        scale.at<cv::Vec3b>(0, static_cast<int>(std::lround(255.f * share)));
    colors.Data()[i] = {bgr[2], bgr[1], bgr[0]};
  }
  return colors;
}

}  // namespace tsar
