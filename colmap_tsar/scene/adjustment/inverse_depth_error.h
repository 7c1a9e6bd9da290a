// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

namespace tsar {

// The error of a plane's inverse depth in a camera: with p = normal / offset in
// the camera's frame, the inverse depth along a ray (z = 1) is -p . ray, and
// this is the covariance of p.
struct InverseDepthError {
  float xx = 0.f;
  float xy = 0.f;
  float xz = 0.f;
  float yy = 0.f;
  float yz = 0.f;
  float zz = 0.f;

  // Variance of the inverse depth along a ray.
  TSAR_HD float Variance(const Vec3f& ray) const {
    const float variance =
        ray.x * (xx * ray.x + 2.f * (xy * ray.y + xz * ray.z)) +
        ray.y * (yy * ray.y + 2.f * yz * ray.z) + zz * ray.z * ray.z;
    // Rounding may make it negative.
    return variance > 0.f ? variance : 0.f;
  }
};

// The plane's covariance propagated to first order, after each variance v
// became 1 / (1 / v + 1 / b^2), with priors b for the planes of rooms: a
// rotation by 0.02 radians, a shift by 1 % of the camera's distance from the
// plane. The result is 0 where the plane contains the camera center and thus
// has no depths.
InverseDepthError ErrorInView(const ModelPlane& plane, const Camera& camera);

}  // namespace tsar
