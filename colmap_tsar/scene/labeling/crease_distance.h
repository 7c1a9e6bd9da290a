// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/plane.h"

#include <cmath>
#include <limits>

namespace tsar {

// The distance in the image, in pixels, of a ray from the intersection of two
// planes: the difference of their inverse depths over its slope. Infinite where
// they are parallel in the image, or the ray does not meet both.
inline float DistanceToCrease(const InverseDepthPlane& a,
                              const InverseDepthPlane& b,
                              const Vec3f& ray,
                              const Intrinsics& intrinsics) {
  const Vec3f gap = a - b;
  const float slope = std::hypot(gap.x / intrinsics.fx, gap.y / intrinsics.fy);
  return Dot(a, ray) > 0.f && Dot(b, ray) > 0.f && slope > 0.f
             ? std::abs(Dot(gap, ray)) / slope
             : std::numeric_limits<float>::infinity();
}

}  // namespace tsar
