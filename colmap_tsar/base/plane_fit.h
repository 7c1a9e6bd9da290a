// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>

namespace tsar {

// A measured point as (x / z, y / z, z) in the camera frame: its ray and its
// depth. z = 0 stands for 'no point'.
using RayDepth = Vec3f;

TSAR_HD inline Vec3f ToPoint(const RayDepth& sample) {
  return {sample.x * sample.z, sample.y * sample.z, sample.z};
}

// The point's distance to the plane as a fraction of its depth.
TSAR_HD inline float RelativeDistance(const Plane& plane,
                                      const RayDepth& sample) {
  return fabsf(Dot(plane.normal, {sample.x, sample.y, 1.f}) +
               plane.offset / sample.z);
}

// Least squares of inverse depth, 1 / z = a x / z + b y / z + c, which is
// linear in the unknowns and suits the noise of stereo, constant in disparity.
class PlaneRegression {
 public:
  TSAR_HD void Add(const RayDepth& sample, double weight) {
    const double u = sample.x;
    const double v = sample.y;
    const double q = 1.0 / sample.z;
    w_ += weight;
    u_ += weight * u;
    v_ += weight * v;
    q_ += weight * q;
    uu_ += weight * u * u;
    uv_ += weight * u * v;
    vv_ += weight * v * v;
    uq_ += weight * u * q;
    vq_ += weight * v * q;
  }

  TSAR_HD PlaneRegression& operator+=(const PlaneRegression& other) {
    w_ += other.w_;
    u_ += other.u_;
    v_ += other.v_;
    q_ += other.q_;
    uu_ += other.uu_;
    uv_ += other.uv_;
    vv_ += other.vv_;
    uq_ += other.uq_;
    vq_ += other.vq_;
    return *this;
  }

  // Returns an invalid plane if the points are collinear or the plane lies
  // behind the camera.
  TSAR_HD Plane Solve() const {
    if (!(w_ > 0.0)) {
      return {};
    }
    const double u = u_ / w_;
    const double v = v_ / w_;
    const double q = q_ / w_;
    const double uu = uu_ / w_ - u * u;
    const double uv = uv_ / w_ - u * v;
    const double vv = vv_ / w_ - v * v;
    const double uq = uq_ / w_ - u * q;
    const double vq = vq_ / w_ - v * q;
    const double determinant = uu * vv - uv * uv;
    const double spread = uu + vv;
    if (!(determinant > 1e-6 * spread * spread)) {
      return {};
    }
    const double a = (uq * vv - vq * uv) / determinant;
    const double b = (vq * uu - uq * uv) / determinant;
    const double c = q - a * u - b * v;
    const double norm = sqrt(a * a + b * b + c * c);
    if (!(norm > 0.0)) {
      return {};
    }
    Plane plane;
    plane.normal = {static_cast<float>(-a / norm),
                    static_cast<float>(-b / norm),
                    static_cast<float>(-c / norm)};
    plane.offset = static_cast<float>(1.0 / norm);
    return plane;
  }

 private:
  double w_ = 0, u_ = 0, v_ = 0, q_ = 0;
  double uu_ = 0, uv_ = 0, vv_ = 0, uq_ = 0, vq_ = 0;
};

}  // namespace tsar
