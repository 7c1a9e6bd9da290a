// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/depth_colors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

constexpr double kIgnoredShare = 0.02;
// Keeps the ends of the range apart where all depths are the same.
constexpr float kMinRelativeRange = 0.01f;
// OpenCV's scale begins with a violet that is nearly black, as holes are.
constexpr int kNumDarkColors = 24;
constexpr int kNumColors = 256 - kNumDarkColors;

std::vector<Rgb> ColorScale() {
  cv::Mat codes(1, kNumColors, CV_8UC1);
  for (int i = 0; i < kNumColors; ++i) {
    codes.at<uint8_t>(0, i) = static_cast<uint8_t>(255 - i);
  }
  cv::Mat colors;
  cv::applyColorMap(codes, colors, cv::COLORMAP_TURBO);
  std::vector<Rgb> scale;
  for (int i = 0; i < kNumColors; ++i) {
    const cv::Vec3b& bgr = colors.at<cv::Vec3b>(0, i);
    scale.push_back({bgr[2], bgr[1], bgr[0]});
  }
  return scale;
}

}  // namespace

DepthRange RobustDepthRange(const Image<float>& before,
                            const Image<float>& after) {
  std::vector<float> depths;
  for (const Image<float>* map : {&before, &after}) {
    std::copy_if(
        map->begin(), map->end(), std::back_inserter(depths), [](float depth) {
          return depth > 0.f;
        });
  }
  if (depths.empty()) {
    return {1.f, 2.f};
  }
  const auto value_at = [&depths](size_t rank) {
    std::nth_element(depths.begin(), depths.begin() + rank, depths.end());
    return depths[rank];
  };
  const size_t last = depths.size() - 1;
  const size_t skipped = static_cast<size_t>(kIgnoredShare * last);
  const float nearest = value_at(skipped);
  const float farthest = value_at(last - skipped);
  return {nearest, std::max(farthest, nearest * (1.f + kMinRelativeRange))};
}

Image<Rgb> ColorizeDepth(const Image<float>& depth, const DepthRange& range) {
  const std::vector<Rgb> scale = ColorScale();
  Image<Rgb> colors(depth.Width(), depth.Height());
  std::transform(depth.begin(), depth.end(), colors.begin(), [&](float value) {
    if (!(value > 0.f)) {
      return Rgb();
    }
    const float position =
        (value - range.nearest) / (range.farthest - range.nearest);
    return scale[std::lround(std::clamp(position, 0.f, 1.f) *
                             (kNumColors - 1))];
  });
  return colors;
}

}  // namespace tsar
