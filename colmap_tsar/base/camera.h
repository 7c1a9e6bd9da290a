// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"

#include <Eigen/Core>

namespace tsar {

// The vector rounded to floats.
inline Vec3f ToVec3f(const Eigen::Vector3d& vector) {
  return {static_cast<float>(vector.x()),
          static_cast<float>(vector.y()),
          static_cast<float>(vector.z())};
}

// Pinhole intrinsics in pixels. Pixel (col, row) has the ray ((col - cx) / fx,
// (row - cy) / fy, 1): pixel centers have integer coordinates, as in COLMAP's
// dense stage.
struct Intrinsics {
  float fx = 1.f;
  float fy = 1.f;
  float cx = 0.f;
  float cy = 0.f;

  TSAR_HD Vec3f Ray(float x, float y) const {
    return {(x - cx) / fx, (y - cy) / fy, 1.f};
  }
  // Pixel position of a point in the camera frame; point.z must not be 0.
  TSAR_HD void Project(const Vec3f& point, float* x, float* y) const {
    const float inverse_z = 1.f / point.z;
    *x = fx * point.x * inverse_z + cx;
    *y = fy * point.y * inverse_z + cy;
  }
};

// A calibrated image: x_cam = rotation * x_world + translation, in the units of
// the sparse model; x right, y down, z forward. Double precision is used, since
// georeferenced models have coordinates of seven integer digits.
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 1.0;
  double fy = 1.0;
  double cx = 0.0;
  double cy = 0.0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d Center() const { return -rotation.transpose() * translation; }

  // Returns the camera for an image of another size. Depth maps may be smaller
  // than their images; COLMAP scales every intrinsic by the ratio of the sizes.
  Camera Resized(int new_width, int new_height) const;

  Intrinsics GetIntrinsics() const;
};

// x_source = rotation * x_reference + translation, in camera frames.
struct RelativePose {
  Mat3f rotation;
  Vec3f translation;

  TSAR_HD Vec3f operator*(const Vec3f& point) const {
    return rotation * point + translation;
  }
};

// The pose of source relative to reference, composed in double precision.
RelativePose ComputeRelativePose(const Camera& reference, const Camera& source);

}  // namespace tsar
