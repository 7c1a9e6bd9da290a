// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fusion_pixel.h"

#include <algorithm>

namespace tsar {

void EncodeNormal(const Vec3f& normal, FusionPixel* pixel) {
  const float sum =
      std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
  if (!(sum > 0.f)) {
    pixel->normal_x = FusionPixel::kNoNormal;
    pixel->normal_y = 0;
    return;
  }
  float x = normal.x / sum;
  float y = normal.y / sum;
  if (normal.z < 0.f) {
    const float folded_x = (1.f - std::abs(y)) * (x < 0.f ? -1.f : 1.f);
    y = (1.f - std::abs(x)) * (y < 0.f ? -1.f : 1.f);
    x = folded_x;
  }
  pixel->normal_x = static_cast<int16_t>(std::lround(32767.f * x));
  pixel->normal_y = static_cast<int16_t>(std::lround(32767.f * y));
}

uint16_t EncodeSigma(float relative_sigma) {
  const float level = relative_sigma / kSigmaStep;
  return level > 1.f
             ? static_cast<uint16_t>(std::lround(std::min(level, 65535.f)))
             : uint16_t{1};
}

}  // namespace tsar
