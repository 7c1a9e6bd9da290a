// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Planes drawn into depth maps: inputs with known results.

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"

#include <algorithm>
#include <cmath>

namespace tsar {

// A camera at the world's origin that looks along z, principal point in the
// middle.
inline Camera SyntheticCamera(int width, int height, double focal_length) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focal_length;
  camera.fy = focal_length;
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  return camera;
}

// The plane along direction (which need not have unit length) that meets the
// optical axis at this depth.
inline Plane DrawnPlane(const Vec3f& direction, float depth_on_axis) {
  return Plane::FromPoint(
      {0.f, 0.f, 1.f}, depth_on_axis, Normalized(direction));
}

inline Image<float> DrawDepth(const Plane& plane, const Camera& camera) {
  Image<float> depth(camera.width, camera.height);
  const Intrinsics intrinsics = camera.GetIntrinsics();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      depth(x, y) = plane.Depth(intrinsics.Ray(x, y));
    }
  }
  return depth;
}

inline Image<RayDepth> ToSamples(const Image<float>& depth,
                                 const Camera& camera) {
  Image<RayDepth> samples(depth.Width(), depth.Height());
  const Intrinsics intrinsics = camera.GetIntrinsics();
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      if (depth(x, y) > 0.f) {
        const Vec3f ray = intrinsics.Ray(x, y);
        samples(x, y) = {ray.x, ray.y, depth(x, y)};
      }
    }
  }
  return samples;
}

// Square superpixels of this size, numbered row by row.
template <typename T>
Image<T> SquareSuperpixels(int width, int height, int size) {
  Image<T> superpixels(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      superpixels(x, y) = static_cast<T>(y / size * (width / size) + x / size);
    }
  }
  return superpixels;
}

// In degrees, between unit vectors.
inline float AngleBetween(const Vec3f& a, const Vec3f& b) {
  return 2.f * std::asin(std::min(0.5f * Norm(a - b), 1.f)) * 57.29578f;
}

}  // namespace tsar
