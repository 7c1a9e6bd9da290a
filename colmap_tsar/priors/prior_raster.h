// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/priors/axis_sample.h"
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
    const AxisSample column = AxisSample::At(x, depth.width, map_width);
    const AxisSample row = AxisSample::At(y, depth.height, map_height);
    const float corners[] = {depth(column.first, row.first),
                             depth(column.second, row.first),
                             depth(column.first, row.second),
                             depth(column.second, row.second)};
    float least = corners[0];
    float most = corners[0];
    for (const float corner : corners) {
      least = fminf(least, corner);
      most = fmaxf(most, corner);
    }
    const bool is_one_surface = least > 0.f && most - least < kStep * least;
    const float top = corners[0] + column.share * (corners[1] - corners[0]);
    const float bottom = corners[2] + column.share * (corners[3] - corners[2]);
    return {is_one_surface ? top + row.share * (bottom - top)
                           : depth(column.Nearest(), row.Nearest()),
            sigma(column.Nearest(), row.Nearest()),
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
