// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

// Bounds of depth, sampled evenly in inverse depth, as image positions are.
struct DepthBounds {
  float min;
  float max;

  TSAR_HD bool Contains(float depth) const {
    return depth >= min && depth <= max;
  }

  TSAR_HD float Draw(Philox* random) const {
    const float t = random->NextFloat();
    return 1.f / ((1.f - t) / min + t / max);
  }

  // Not farther from the given depth than `share` of the whole range.
  TSAR_HD float DrawAround(float depth, float share, Philox* random) const {
    const float range = 1.f / min - 1.f / max;
    const float inverse =
        1.f / depth + (2.f * random->NextFloat() - 1.f) * share * range;
    return 1.f / fminf(fmaxf(inverse, 1.f / max), 1.f / min);
  }
};

// A direction evenly drawn from those that face a camera which sees the point
// along the ray.
TSAR_HD inline Vec3f DrawNormal(const Vec3f& ray, Philox* random) {
  const float z = 2.f * random->NextFloat() - 1.f;
  const float angle = 6.2831853f * random->NextFloat();
  const float r = sqrtf(fmaxf(0.f, 1.f - z * z));
  const Vec3f normal = {r * cosf(angle), r * sinf(angle), z};
  return Dot(normal, ray) > 0.f ? -normal : normal;
}

// The normal turned by up to about `angle` (radians); itself where that would
// turn it away from the camera.
TSAR_HD inline Vec3f DrawNormalAround(const Vec3f& normal,
                                      float angle,
                                      const Vec3f& ray,
                                      Philox* random) {
  const float scale = tanf(fminf(angle, 1.4f));
  const Vec3f step = {(2.f * random->NextFloat() - 1.f) * scale,
                      (2.f * random->NextFloat() - 1.f) * scale,
                      (2.f * random->NextFloat() - 1.f) * scale};
  const Vec3f turned = Normalized(normal + step);
  return Dot(turned, ray) < 0.f ? turned : normal;
}

}  // namespace tsar
