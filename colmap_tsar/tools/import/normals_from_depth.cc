// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/normals_from_depth.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tsar {
namespace {

// Inverse depth at the neighbor minus that at the pixel; nullopt unless both
// may be on one surface.
std::optional<float> Difference(
    const Image<float>& depth, int x, int y, int step_x, int step_y) {
  constexpr float kMaxJump = 0.05f;
  if (!depth.Contains(x + step_x, y + step_y)) {
    return std::nullopt;
  }
  const float here = depth(x, y);
  const float there = depth(x + step_x, y + step_y);
  if (!(there > 0.f) ||
      std::abs(there - here) > kMaxJump * std::min(here, there)) {
    return std::nullopt;
  }
  return 1.f / there - 1.f / here;
}

// The derivative of the inverse depth along an axis, per pixel.
std::optional<float> Slope(
    const Image<float>& depth, int x, int y, int step_x, int step_y) {
  // Relative noise of the inverse depth on a surface.
  constexpr float kNoise = 0.005f;
  const auto before = Difference(depth, x, y, -step_x, -step_y);
  const auto after = Difference(depth, x, y, step_x, step_y);
  if (!before && !after) {
    return std::nullopt;
  }
  if (!before) {
    return *after;
  }
  if (!after) {
    return -*before;
  }
  const float small = std::min(std::abs(*before), std::abs(*after));
  const float large = std::max(std::abs(*before), std::abs(*after));
  if (large > 2.f * small + kNoise / depth(x, y)) {
    return std::abs(*after) < std::abs(*before) ? *after : -*before;
  }
  return 0.5f * (*after - *before);
}

}  // namespace

Image<Vec3f> NormalsFromDepth(const Image<float>& depth,
                              const Intrinsics& intrinsics) {
  Image<Vec3f> normals(depth.Width(), depth.Height());
  for (int y = 0; y < depth.Height(); ++y) {
    for (int x = 0; x < depth.Width(); ++x) {
      if (!(depth(x, y) > 0.f)) {
        continue;
      }
      const auto slope_x = Slope(depth, x, y, 1, 0);
      const auto slope_y = Slope(depth, x, y, 0, 1);
      if (!slope_x || !slope_y) {
        continue;
      }
      // The plane m . point = 1; m . ray is the inverse depth along the ray.
      const Vec3f ray =
          intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
      Vec3f m = {intrinsics.fx * *slope_x, intrinsics.fy * *slope_y, 0.f};
      m.z = 1.f / depth(x, y) - m.x * ray.x - m.y * ray.y;
      const float norm = Norm(m);
      // The norm is infinite if the inverse of a tiny depth overflows.
      if (norm > 0.f && std::isfinite(norm)) {
        normals(x, y) = -(m * (1.f / norm));
      }
    }
  }
  return normals;
}

}  // namespace tsar
