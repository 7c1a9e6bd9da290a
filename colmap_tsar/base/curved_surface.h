// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

// A quadratic inverse-depth surface in a camera frame: its inverse depth is a
// polynomial of the ray (x, y, 1):
//   1 / z = c0 + c1 u + c2 v + c3 u u + c4 u v + c5 v v,
//   u = (x - middle_x) / extent, v = (y - middle_y) / extent.
// With c3 = c4 = c5 = 0 it is a plane.
struct CurvedSurface {
  float middle_x = 0.f;
  float middle_y = 0.f;
  float extent = 1.f;  // > 0
  float coefficients[6] = {};

  // The tangent plane at the ray's intersection, which has the surface's depth
  // and normal there. Invalid if the ray does not meet the surface.
  TSAR_HD Plane TangentAt(const Vec3f& ray) const {
    const float* c = coefficients;
    const float u = (ray.x - middle_x) / extent;
    const float v = (ray.y - middle_y) / extent;
    const float inverse_depth =
        c[0] + u * (c[1] + c[3] * u + c[4] * v) + v * (c[2] + c[5] * v);
    if (!(inverse_depth > 0.f)) {
      return {};
    }
    // The inverse depth of a plane is linear in the ray, so that the linear
    // expansion about the ray is the tangent plane.
    const float a = (c[1] + 2.f * c[3] * u + c[4] * v) / extent;
    const float b = (c[2] + c[4] * u + 2.f * c[5] * v) / extent;
    const Vec3f gradient = {a, b, inverse_depth - a * ray.x - b * ray.y};
    const float norm = Norm(gradient);
    return {gradient * (-1.f / norm), 1.f / norm};
  }
};

}  // namespace tsar
