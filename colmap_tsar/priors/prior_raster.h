// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/priors/prior_likelihood.h"

#include <cmath>

namespace tsar {

// An aligned prior, sampled at the pixels of a map, which may be larger.
struct PriorRaster {
  ImageView<const float> depth;  // May be empty.
  ImageView<const float> sigma;
  float outlier_share = 0.f;
  Intrinsics intrinsics;  // Of the map.
  int map_width = 0;
  int map_height = 0;

  // The relative step of depth from which neighbors belong to two surfaces.
  static constexpr float kStep = 0.03f;

  // Interpolates depths between the pixels of one surface; at its border takes
  // those of the nearest pixel.
  TSAR_HD PriorDepth At(int x, int y) const {
    if (depth.Empty()) {
      return {};
    }
    const float u = (x + 0.5f) * depth.width / map_width - 0.5f;
    const float v = (y + 0.5f) * depth.height / map_height - 0.5f;
    const int nearest_x =
        Clamp(static_cast<int>(floorf(u + 0.5f)), depth.width);
    const int nearest_y =
        Clamp(static_cast<int>(floorf(v + 0.5f)), depth.height);
    const int x0 = Clamp(static_cast<int>(floorf(u)), depth.width);
    const int y0 = Clamp(static_cast<int>(floorf(v)), depth.height);
    const int x1 = Clamp(x0 + 1, depth.width);
    const int y1 = Clamp(y0 + 1, depth.height);
    const float s = fminf(fmaxf(u - x0, 0.f), 1.f);
    const float t = fminf(fmaxf(v - y0, 0.f), 1.f);
    const float corners[] = {
        depth(x0, y0), depth(x1, y0), depth(x0, y1), depth(x1, y1)};
    float least = corners[0];
    float most = corners[0];
    for (const float corner : corners) {
      least = fminf(least, corner);
      most = fmaxf(most, corner);
    }
    const bool is_one_surface = least > 0.f && most - least < kStep * least;
    const float top = corners[0] + s * (corners[1] - corners[0]);
    const float bottom = corners[2] + s * (corners[3] - corners[2]);
    return {
        is_one_surface ? top + t * (bottom - top) : depth(nearest_x, nearest_y),
        sigma(nearest_x, nearest_y),
        outlier_share};
  }

  // The normal from the surrounding depths, towards the camera; the direction
  // to the camera where these determine none.
  TSAR_HD Vec3f NormalAt(int x, int y) const {
    const int step = map_width / depth.width > 1 ? map_width / depth.width : 1;
    const Vec3f ray = intrinsics.Ray(x, y);
    const Vec3f middle = ray * At(x, y).depth;
    const Vec3f right = Difference(x, y, step, 0, middle);
    const Vec3f down = Difference(x, y, 0, step, middle);
    const Vec3f normal = Cross(down, right);
    const float length = Norm(normal);
    if (!(length > 0.f)) {
      return ray * (-1.f / Norm(ray));
    }
    return normal * ((Dot(normal, ray) < 0.f ? 1.f : -1.f) / length);
  }

 private:
  TSAR_HD static int Clamp(int i, int size) {
    return i < 0 ? 0 : (i >= size ? size - 1 : i);
  }

  // The difference to the neighbor of the same surface on either side, in the
  // direction of the step.
  TSAR_HD Vec3f
  Difference(int x, int y, int step_x, int step_y, const Vec3f& middle) const {
    for (const int sign : {1, -1}) {
      const int i = x + sign * step_x;
      const int j = y + sign * step_y;
      if (i < 0 || j < 0 || i >= map_width || j >= map_height) {
        continue;
      }
      const float z = At(i, j).depth;
      if (z > 0.f && fabsf(z - middle.z) < kStep * middle.z) {
        return (intrinsics.Ray(i, j) * z - middle) * static_cast<float>(sign);
      }
    }
    return {};
  }
};

}  // namespace tsar
