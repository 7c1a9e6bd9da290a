// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/colors.h"

#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

static_assert(kProvenanceColors.size() == kProvenanceNames.size());

constexpr double kIgnoredShare = 0.02;
// The least relative range, for maps of equal depths.
constexpr float kMinRelativeRange = 0.01f;
// Skipped colors: OpenCV's scale begins with a violet as dark as holes.
constexpr int kNumDarkColors = 24;
constexpr int kNumColors = 256 - kNumDarkColors;

// All 256 colors of one of OpenCV's scales.
std::vector<Rgb> ColorScale(cv::ColormapTypes type) {
  cv::Mat codes(1, 256, CV_8UC1);
  std::iota(codes.begin<uint8_t>(), codes.end<uint8_t>(), uint8_t{0});
  cv::Mat colors;
  cv::applyColorMap(codes, colors, type);
  std::vector<Rgb> scale;
  for (int i = 0; i < 256; ++i) {
    const cv::Vec3b& bgr = colors.at<cv::Vec3b>(0, i);
    scale.push_back({bgr[2], bgr[1], bgr[0]});
  }
  return scale;
}

// Maps [-1, 1] to the range of a byte.
uint8_t ToByte(float component) {
  return static_cast<uint8_t>(
      std::lround(std::clamp(0.5f * component + 0.5f, 0.f, 1.f) * 255.f));
}

// One channel of an HSV color; the hue is in turns.
uint8_t Channel(double hue, double saturation, double brightness) {
  const double distance = std::abs(hue - std::floor(hue) - 0.5) * 6.0;
  const double share = std::clamp(distance - 1.0, 0.0, 1.0);
  return static_cast<uint8_t>(
      std::lround(brightness * (1.0 - saturation * (1.0 - share))));
}

// The color of a plane by its number in plane maps.
Rgb PlaneColor(uint16_t number) {
  if (number == 0) {
    return {};
  }
  // The golden ratio spreads the hues of any first planes evenly.
  const double hue = number * 0.6180339887498949;
  // Numbers that differ by 5, 8 or 13 have nearly the same hue and differ in
  // these.
  const double saturation = number % 3 == 0   ? 0.7
                            : number % 3 == 1 ? 0.45
                                              : 0.85;
  const double brightness = number % 4 < 2 ? 240.0 : 165.0;
  return {Channel(hue, saturation, brightness),
          Channel(hue - 1.0 / 3.0, saturation, brightness),
          Channel(hue - 2.0 / 3.0, saturation, brightness)};
}

template <typename Value, typename ToColor>
Image<Rgb> Colorize(const Image<Value>& values, const ToColor& to_color) {
  Image<Rgb> colors(values.Width(), values.Height());
  std::ranges::transform(values, colors.begin(), to_color);
  return colors;
}

}  // namespace

DepthRange RobustDepthRange(const Image<float>& before,
                            const Image<float>& after) {
  std::vector<float> depths;
  for (const Image<float>* map : {&before, &after}) {
    std::ranges::copy_if(*map, std::back_inserter(depths), [](float depth) {
      return depth > 0.f;
    });
  }
  if (depths.empty()) {
    return {1.f, 2.f};
  }
  const auto value_at = [&depths](size_t rank) {
    std::ranges::nth_element(depths, depths.begin() + rank);
    return depths[rank];
  };
  const size_t last = depths.size() - 1;
  const size_t skipped = static_cast<size_t>(kIgnoredShare * last);
  const float nearest = value_at(skipped);
  const float farthest = value_at(last - skipped);
  return {nearest, std::max(farthest, nearest * (1.f + kMinRelativeRange))};
}

Image<Rgb> ColorizeDepth(const Image<float>& depth, const DepthRange& range) {
  const std::vector<Rgb> scale = ColorScale(cv::COLORMAP_TURBO);
  return Colorize(depth, [&](float value) {
    if (!(value > 0.f)) {
      return Rgb();
    }
    const float position =
        (value - range.nearest) / (range.farthest - range.nearest);
    return scale[255 - std::lround(std::clamp(position, 0.f, 1.f) *
                                   (kNumColors - 1))];
  });
}

Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals) {
  return Colorize(normals, [](const Vec3f& normal) {
    // The comparison also fails for NaN.
    return Dot(normal, normal) > 0.f
               ? Rgb{ToByte(normal.x), ToByte(-normal.y), ToByte(-normal.z)}
               : Rgb();
  });
}

Image<Rgb> ColorizeConfidence(const Image<uint8_t>& confidence) {
  std::vector<Rgb> scale = ColorScale(cv::COLORMAP_VIRIDIS);
  scale[0] = Rgb();
  return Colorize(confidence, [&](uint8_t level) { return scale[level]; });
}

Image<Rgb> ColorizePlanes(const Image<uint16_t>& planes) {
  return Colorize(planes, PlaneColor);
}

Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance) {
  return Colorize(provenance,
                  [](uint8_t value) { return kProvenanceColors.at(value); });
}

}  // namespace tsar
