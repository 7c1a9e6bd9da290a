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
      planes_(planes),
      full_gap_(full_gap) {
  rays_.reserve(borders_.size() *
                static_cast<size_t>(SuperpixelBorder::kNumPixels));
  for (const SuperpixelBorder& border : borders_) {
    for (const int pixel : border.pixels) {
      rays_.push_back(
          intrinsics.Ray(pixel % evidence.width, pixel / evidence.width));
    }
  }
}

float BorderCosts::operator()(int edge, int a, int b) const {
  if (a == b) {
    return 0.f;
  }
  const float weight = borders_[static_cast<size_t>(edge)].weight;
  if (static_cast<size_t>(std::max(a, b)) == planes_.size()) {
    return weight;
  }
  const Plane& first = planes_[static_cast<size_t>(a)];
  const Plane& second = planes_[static_cast<size_t>(b)];
  const Vec3f* rays =
      rays_.data() + static_cast<size_t>(edge) * SuperpixelBorder::kNumPixels;
  float sum = 0.f;
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    const float first_depth = first.Depth(rays[i]);
    const float second_depth = second.Depth(rays[i]);
    const float nearer = std::min(first_depth, second_depth);
    if (!(nearer > 0.f)) {
      sum += 1.f;
      continue;
    }
    const float gap = std::abs(first_depth - second_depth) /
                      (nearer * resolution_.RelativeDepthError(nearer));
    sum += std::min(gap / full_gap_, 1.f);
  }
  return weight * sum / SuperpixelBorder::kNumPixels;
}

}  // namespace tsar
