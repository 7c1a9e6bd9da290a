// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

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
