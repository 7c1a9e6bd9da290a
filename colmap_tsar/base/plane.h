// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

namespace tsar {

// The plane normal . X + offset = 0 in a camera frame. The normal is a unit
// vector that points to the camera, so offset is the plane's distance from the
// camera's center. normal = 0 stands for 'no plane'.
struct Plane {
  Vec3f normal;
  float offset = 0.f;

  TSAR_HD bool Valid() const { return offset > 0.f; }

  // Depth (z) at which a ray with z = 1 meets the plane, or 0 if it meets it
  // behind the camera, from behind or nearly parallel to it.
  TSAR_HD float Depth(const Vec3f& ray) const {
    const float slope = -Dot(normal, ray);
    return slope > 1e-4f * Norm(ray) ? offset / slope : 0.f;
  }

  // The plane through the point depth * ray with this normal.
  TSAR_HD static Plane FromPoint(const Vec3f& ray,
                                 float depth,
                                 const Vec3f& normal) {
    return {normal, -depth * Dot(normal, ray)};
  }

  // The plane through three points, facing the camera; invalid when they lie on
  // a line or the plane holds the camera's center.
  TSAR_HD static Plane FromPoints(const Vec3f& a,
                                  const Vec3f& b,
                                  const Vec3f& c) {
    const Vec3f ab = b - a;
    const Vec3f ac = c - a;
    const Vec3f cross = Cross(ab, ac);
    const float area = Norm(cross);
    // The area is compared with the sides: thin triangles give no usable
    // normal.
    if (!(area > 1e-3f * Norm(ab) * Norm(ac))) {
      return {};
    }
    Plane plane;
    plane.normal = cross * (1.f / area);
    plane.offset = -Dot(plane.normal, a);
    if (plane.offset < 0.f) {
      plane.normal = -plane.normal;
      plane.offset = -plane.offset;
    }
    return plane;
  }
};

// A plane as the inverse of its depth along a ray, which is the dot product of
// this and the ray, and so linear in the image; zero where there is none.
using InverseDepthPlane = Vec3f;

TSAR_HD inline InverseDepthPlane ToInverseDepth(const Plane& plane) {
  return plane.Valid() ? plane.normal * (-1.f / plane.offset)
                       : InverseDepthPlane{};
}

}  // namespace tsar
