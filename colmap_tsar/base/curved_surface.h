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

// A straight circular cylinder in a camera frame.
struct Cylinder {
  Vec3f point;  // On the axis, at height 0.
  Vec3f axis;   // A unit vector.
  float radius = 0.f;

  struct Intersection {
    float depth = 0.f;   // Along the camera's optical axis, > 0.
    float height = 0.f;  // Along the cylinder's axis.
    Vec3f normal;        // A unit vector that points to the camera.
  };

  // Computes the first intersection of a ray with z = 1 from the camera's
  // center with the outer side. Returns false if there is none or the ray is
  // parallel to the axis.
  TSAR_HD bool Intersect(const Vec3f& ray, Intersection* intersection) const {
    const Vec3f across = ray - axis * Dot(ray, axis);
    const Vec3f center = point - axis * Dot(point, axis);
    const float a = Dot(across, across);
    const float b = Dot(across, center);
    const float c = Dot(center, center) - radius * radius;
    const float discriminant = b * b - a * c;
    if (!(discriminant > 0.f) || !(c > 0.f) || !(a > 0.f)) {
      return false;
    }
    const float depth = (b - sqrtf(discriminant)) / a;
    if (!(depth > 0.f)) {
      return false;
    }
    intersection->depth = depth;
    intersection->height = Dot(ray * depth - point, axis);
    intersection->normal = Normalized(across * depth - center);
    return true;
  }
};

}  // namespace tsar
