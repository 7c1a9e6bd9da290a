// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/normal_colors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {
namespace {

// From [-1, 1] to all of a byte.
uint8_t ToByte(float component) {
  return static_cast<uint8_t>(
      std::lround(std::clamp(0.5f * component + 0.5f, 0.f, 1.f) * 255.f));
}

}  // namespace

Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals) {
  Image<Rgb> colors(normals.Width(), normals.Height());
  std::transform(
      normals.begin(), normals.end(), colors.begin(), [](const Vec3f& normal) {
        // Not where a component is not a number, either.
        return Dot(normal, normal) > 0.f
                   ? Rgb{ToByte(normal.x), ToByte(-normal.y), ToByte(-normal.z)}
                   : Rgb();
      });
  return colors;
}

}  // namespace tsar
