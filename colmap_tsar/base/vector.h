// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

#include <cmath>

namespace tsar {

// Three floats with the arithmetic that kernels need. Host code that solves
// systems uses Eigen; this type has a fixed order of rounding on CPU and GPU.
struct Vec3f {
  float x = 0.f;
  float y = 0.f;
  float z = 0.f;
};

TSAR_HD inline Vec3f operator+(const Vec3f& a, const Vec3f& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
TSAR_HD inline Vec3f operator-(const Vec3f& a, const Vec3f& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
TSAR_HD inline Vec3f operator-(const Vec3f& a) { return {-a.x, -a.y, -a.z}; }
TSAR_HD inline Vec3f operator*(const Vec3f& a, float s) {
  return {a.x * s, a.y * s, a.z * s};
}
TSAR_HD inline Vec3f operator*(float s, const Vec3f& a) { return a * s; }
TSAR_HD inline bool operator==(const Vec3f& a, const Vec3f& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

TSAR_HD inline float Dot(const Vec3f& a, const Vec3f& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
TSAR_HD inline Vec3f Cross(const Vec3f& a, const Vec3f& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
TSAR_HD inline float Norm(const Vec3f& a) { return sqrtf(Dot(a, a)); }

// The unit vector along a, or zero where a has no direction.
TSAR_HD inline Vec3f Normalized(const Vec3f& a) {
  const float norm = Norm(a);
  return norm > 0.f ? a * (1.f / norm) : Vec3f{};
}

// A 3x3 matrix in row-major order.
struct Mat3f {
  Vec3f row0;
  Vec3f row1;
  Vec3f row2;
};

TSAR_HD inline Vec3f operator*(const Mat3f& m, const Vec3f& v) {
  return {Dot(m.row0, v), Dot(m.row1, v), Dot(m.row2, v)};
}
TSAR_HD inline Vec3f TransposeTimes(const Mat3f& m, const Vec3f& v) {
  return m.row0 * v.x + m.row1 * v.y + m.row2 * v.z;
}

}  // namespace tsar
