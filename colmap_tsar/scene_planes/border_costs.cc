// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/border_costs.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tsar {

BorderCosts::BorderCosts(const ViewEvidence& evidence,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const std::vector<Plane>& planes,
                         float full_gap)
    : borders_(evidence.borders),
      resolution_(resolution),
      full_gap_(full_gap),
      num_planes_(static_cast<int>(planes.size())) {
  constexpr auto kNumPixels = static_cast<size_t>(SuperpixelBorder::kNumPixels);
  depths_.resize(borders_.size() * planes.size() * kNumPixels);
  float* depth = depths_.data();
  for (const SuperpixelBorder& border : borders_) {
    for (const Plane& plane : planes) {
      for (const int pixel : border.pixels) {
        *depth++ = plane.Depth(
            intrinsics.Ray(pixel % evidence.width, pixel / evidence.width));
      }
    }
  }
}

float BorderCosts::operator()(int edge, int a, int b) const {
  if (a == b) {
    return 0.f;
  }
  const float weight = borders_[static_cast<size_t>(edge)].weight;
  if (a == num_planes_ || b == num_planes_) {
    return weight;
  }
  const float* first = Depths(edge, a);
  const float* second = Depths(edge, b);
  float sum = 0.f;
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    const float nearer = std::min(first[i], second[i]);
    if (!(nearer > 0.f)) {
      sum += 1.f;
      continue;
    }
    const float gap = std::abs(first[i] - second[i]) /
                      (nearer * resolution_.RelativeDepthError(nearer));
    sum += std::min(gap / full_gap_, 1.f);
  }
  return weight * sum / SuperpixelBorder::kNumPixels;
}

}  // namespace tsar
