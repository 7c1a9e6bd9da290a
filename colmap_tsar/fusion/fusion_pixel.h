// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {

// The data of one pixel for fusion, in as many bytes as a GPU reads at once.
struct alignas(16) FusionPixel {
  static constexpr int16_t kNoNormal = -32768;

  float depth = 0.f;  // z in the camera's frame; 0: none.
  // The normal, towards the camera, by EncodeNormal().
  int16_t normal_x = kNoNormal;
  int16_t normal_y = 0;
  Rgb color;
  uint8_t confidence = 0;  // See ToConfidenceLevel().
  // The standard deviation relative to the depth, in kSigmaStep; at least 1.
  uint16_t sigma = 1;
};
static_assert(sizeof(FusionPixel) == 16);

constexpr float kSigmaStep = 1.f / (1 << 18);

// Encodes unit vectors by the octahedral map (Cigolle et al., A survey of
// efficient representations for independent unit vectors, JCGT 2014), to about
// 1e-4 radians; the zero vector, which represents an unknown normal, exactly.
inline void EncodeNormal(const Vec3f& normal, FusionPixel* pixel) {
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
  pixel->normal_x = static_cast<int16_t>(RoundToInt(32767.f * x));
  pixel->normal_y = static_cast<int16_t>(RoundToInt(32767.f * y));
}

TSAR_HD inline Vec3f DecodeNormal(const FusionPixel& pixel) {
  if (pixel.normal_x == FusionPixel::kNoNormal) {
    return {};
  }
  float x = static_cast<float>(pixel.normal_x) / 32767.f;
  float y = static_cast<float>(pixel.normal_y) / 32767.f;
  const float z = 1.f - fabsf(x) - fabsf(y);
  if (z < 0.f) {
    const float folded_x = (1.f - fabsf(y)) * (x < 0.f ? -1.f : 1.f);
    y = (1.f - fabsf(x)) * (y < 0.f ? -1.f : 1.f);
    x = folded_x;
  }
  return Normalized({x, y, z});
}

// The encoding of a standard deviation relative to the depth.
inline uint16_t EncodeSigma(float relative_sigma) {
  const float level = relative_sigma / kSigmaStep;
  return level > 1.f
             ? static_cast<uint16_t>(RoundToInt(std::min(level, 65535.f)))
             : uint16_t{1};
}

}  // namespace tsar
