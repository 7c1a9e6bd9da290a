// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/observed_source.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace tsar {
namespace {

constexpr size_t kMaxSamples = 4000;
constexpr size_t kMinSamples = 100;
// The range of colors that are neither black nor clipped.
constexpr int kMinLevel = 10;
constexpr int kMaxLevel = 250;
constexpr float kSameSurface = 0.02f;  // Relative to the depth.
// Log ratios further from the median are of other surfaces, highlights or
// shadows.
constexpr float kMaxLogRatio = 0.3f;
// The largest vignetting of a lens at the corners.
constexpr float kMaxFalloff = 0.6f;

// The colors of one point in both views.
struct SharedColor {
  std::array<float, 3> log_ratios;  // Reference over source, by channel.
  float radius_difference;          // Source less reference.
};

bool IsUsable(const Rgb& color) {
  return std::min({color.r, color.g, color.b}) >= kMinLevel &&
         std::max({color.r, color.g, color.b}) <= kMaxLevel;
}

std::vector<SharedColor> FindSharedColors(const ObservedView& reference,
                                          const ObservedView& source) {
  const ViewEvidence& own = *reference.evidence;
  const ViewEvidence& other = *source.evidence;
  const ObservedSource view = MakeObservedSource(reference, source);
  const Intrinsics intrinsics = reference.camera.GetIntrinsics();
  const size_t num_pixels = own.confident_depth.NumPixels();
  const size_t step = std::max<size_t>(1, num_pixels / kMaxSamples);
  std::vector<SharedColor> result;
  for (size_t i = step / 2; i < num_pixels; i += step) {
    const int x = static_cast<int>(i % own.width);
    const int y = static_cast<int>(i / own.width);
    const float depth = own.confident_depth(x, y);
    const Vec3f ray = intrinsics.Ray(x, y);
    SeenPoint seen;
    if (!(depth > 0.f) || !FindInSource(view, ray * depth, &seen)) {
      continue;
    }
    const float there = other.confident_depth(seen.column, seen.row);
    const Rgb a = own.color(x, y);
    const Rgb b = other.color(seen.column, seen.row);
    if (std::abs(there - seen.depth) >= kSameSurface * seen.depth ||
        !IsUsable(a) || !IsUsable(b)) {
      continue;
    }
    const auto log_ratio = [](uint8_t of_own, uint8_t of_other) {
      return std::log(static_cast<float>(of_own) / of_other);
    };
    result.push_back(
        {{log_ratio(a.r, b.r), log_ratio(a.g, b.g), log_ratio(a.b, b.b)},
         SquaredRadius(seen.x, seen.y, view.width, view.height) -
             SquaredRadius(x, y, own.width, own.height)});
  }
  return result;
}

// The slope of the log ratios of green over the radii, for ratios near the
// median.
float FitFalloff(const std::vector<SharedColor>& colors, float median) {
  double count = 0.0;
  double x = 0.0;
  double y = 0.0;
  double xx = 0.0;
  double xy = 0.0;
  for (const SharedColor& color : colors) {
    const double ratio = color.log_ratios[1] - median;
    const double radius = color.radius_difference;
    if (std::abs(ratio) < kMaxLogRatio) {
      count += 1.0;
      x += radius;
      y += ratio;
      xx += radius * radius;
      xy += radius * ratio;
    }
  }
  const double variance = count * xx - x * x;
  return variance > 0.0
             ? static_cast<float>(std::clamp((count * xy - x * y) / variance,
                                             -double{kMaxFalloff},
                                             double{kMaxFalloff}))
             : 0.f;
}

}  // namespace

ObservedSource MakeObservedSource(const ObservedView& reference,
                                  const ObservedView& source) {
  ObservedSource view;
  view.intrinsics = source.camera.GetIntrinsics();
  view.from_reference = ComputeRelativePose(reference.camera, source.camera);
  view.resolution = source.evidence->resolution;
  view.width = source.camera.width;
  view.height = source.camera.height;
  return view;
}

ColorGain EstimateColorGain(const ObservedView& reference,
                            const ObservedView& source) {
  const std::vector<SharedColor> colors = FindSharedColors(reference, source);
  ColorGain gain;
  if (colors.size() < kMinSamples) {
    return gain;
  }
  const auto median_of = [&](size_t channel) {
    std::vector<float> ratios;
    for (const SharedColor& color : colors) {
      ratios.push_back(color.log_ratios[channel] -
                       gain.falloff * color.radius_difference);
    }
    return UpperMedian(&ratios);
  };
  gain.falloff = FitFalloff(colors, median_of(1));
  gain.balance = {
      std::exp(median_of(0)), std::exp(median_of(1)), std::exp(median_of(2))};
  return gain;
}

}  // namespace tsar
