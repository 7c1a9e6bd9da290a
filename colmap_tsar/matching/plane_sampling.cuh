// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/random.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

// Bounds of depth, sampled uniformly in inverse depth, hence in image position.
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

  // Draws a depth within `share` of the full range of the given depth.
  TSAR_HD float DrawAround(float depth, float share, Philox* random) const {
    const float range = 1.f / min - 1.f / max;
    const float inverse =
        1.f / depth + (2.f * random->NextFloat() - 1.f) * share * range;
    return 1.f / fminf(fmaxf(inverse, 1.f / max), 1.f / min);
  }
};

// A random normal, uniform among those that face the camera on the ray.
TSAR_HD inline Vec3f DrawNormal(const Vec3f& ray, Philox* random) {
  // A point of the disc is mapped to the sphere (Marsaglia, 1972): unlike sines
  // and cosines, this is bit-identical on CPU and GPU.
  float x = 0.f;
  float y = 0.f;
  float squared = 0.f;
  do {
    x = 2.f * random->NextFloat() - 1.f;
    y = 2.f * random->NextFloat() - 1.f;
    squared = x * x + y * y;
  } while (squared >= 1.f);
  const float scale = 2.f * sqrtf(1.f - squared);
  const Vec3f normal = {scale * x, scale * y, 1.f - 2.f * squared};
  return Dot(normal, ray) > 0.f ? -normal : normal;
}

// The normal perturbed by up to `turn` along each axis; unchanged if the result
// would face away from the camera.
TSAR_HD inline Vec3f DrawNormalAround(const Vec3f& normal,
                                      float turn,
                                      const Vec3f& ray,
                                      Philox* random) {
  const Vec3f step = {(2.f * random->NextFloat() - 1.f) * turn,
                      (2.f * random->NextFloat() - 1.f) * turn,
                      (2.f * random->NextFloat() - 1.f) * turn};
  const Vec3f turned = Normalized(normal + step);
  return Dot(turned, ray) < 0.f ? turned : normal;
}

}  // namespace tsar
