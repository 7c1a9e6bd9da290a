// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/map_levels.h"

#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/view/refined_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace tsar {
namespace {

uint16_t ToLevel(double value) {
  return static_cast<uint16_t>(std::lround(value));
}

float Median(std::vector<float>* values) {
  const auto middle =
      values->begin() + static_cast<std::ptrdiff_t>((values->size() - 1) / 2);
  std::ranges::nth_element(*values, middle);
  return *middle;
}

}  // namespace

Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range) {
  Image<uint16_t> levels(depth.Width(), depth.Height());
  std::ranges::transform(depth, levels.begin(), [&](float z) -> uint16_t {
    const double level = z / step;
    if (level >= 0.5 && level < kMaxLevel + 0.5) {
      return ToLevel(level);
    }
    *num_out_of_range += z > 0.f ? 1 : 0;
    return 0;
  });
  return levels;
}

Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step) {
  Image<uint16_t> levels(sigma.Width(), sigma.Height());
  std::ranges::transform(sigma, levels.begin(), [&](float s) -> uint16_t {
    return s > 0.f ? ToLevel(std::clamp(s / step, 1.0, 1.0 * kMaxLevel)) : 0;
  });
  return levels;
}

Image<Rgb16> NormalLevels(const Image<Vec3f>& normal) {
  const auto to_level = [](float value) {
    const double bounded = std::clamp(value, -1.f, 1.f);
    return ToLevel((bounded - kNormalOffset) / kNormalScale);
  };
  Image<Rgb16> levels(normal.Width(), normal.Height());
  std::ranges::transform(normal, levels.begin(), [&](const Vec3f& n) {
    return Rgb16{to_level(n.x), to_level(n.y), to_level(n.z)};
  });
  return levels;
}

Image<float> ConfidencesOf(const Image<uint8_t>& levels) {
  Image<float> confidences(levels.Width(), levels.Height());
  std::ranges::transform(levels, confidences.begin(), &ConfidenceOfLevel);
  return confidences;
}

double StepFor(double depth) {
  const double exact = depth / kMaxLevel;
  const double digit = std::pow(10.0, std::floor(std::log10(exact)));
  return digit * std::ceil(exact / digit);
}

DepthStatistics MeasureDepth(const Image<float>& depth) {
  std::vector<float> depths;
  depths.reserve(depth.NumPixels());
  std::ranges::copy_if(
      depth, std::back_inserter(depths), [](float z) { return z > 0.f; });
  DepthStatistics statistics;
  if (!depths.empty()) {
    const auto [nearest, farthest] = std::ranges::minmax_element(depths);
    statistics = {static_cast<int64_t>(depths.size()), *nearest, *farthest};
    statistics.median = Median(&depths);
  }
  return statistics;
}

DepthStatistics JoinStatistics(const std::vector<DepthStatistics>& maps) {
  DepthStatistics joined;
  std::vector<float> medians;
  for (const DepthStatistics& map : maps) {
    if (map.num_depths > 0) {
      joined.nearest = joined.num_depths > 0
                           ? std::min(joined.nearest, map.nearest)
                           : map.nearest;
      joined.farthest = std::max(joined.farthest, map.farthest);
      joined.num_depths += map.num_depths;
      medians.push_back(map.median);
    }
  }
  if (!medians.empty()) {
    joined.median = Median(&medians);
  }
  return joined;
}

std::string ShareOfDepths(int64_t count, int64_t num_depths) {
  TextStream text;
  text.precision(3);
  text << 100.0 * static_cast<double>(count) / static_cast<double>(num_depths)
       << " % of the depths";
  return text.str();
}

}  // namespace tsar
