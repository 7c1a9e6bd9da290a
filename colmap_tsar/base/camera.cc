// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/camera.h"

namespace tsar {

Camera Camera::Resized(int new_width, int new_height) const {
  const double scale_x = static_cast<double>(new_width) / width;
  const double scale_y = static_cast<double>(new_height) / height;
  Camera resized = *this;
  resized.width = new_width;
  resized.height = new_height;
  resized.fx *= scale_x;
  resized.fy *= scale_y;
  resized.cx *= scale_x;
  resized.cy *= scale_y;
  return resized;
}

Intrinsics Camera::GetIntrinsics() const {
  return {static_cast<float>(fx),
          static_cast<float>(fy),
          static_cast<float>(cx),
          static_cast<float>(cy)};
}

RelativePose ComputeRelativePose(const Camera& reference,
                                 const Camera& source) {
  const Eigen::Matrix3d rotation =
      source.rotation * reference.rotation.transpose();
  // The centers are used rather than t_src - R t_ref: their difference keeps
  // its digits when both are far from the world's origin.
  const Eigen::Vector3d translation =
      source.rotation * (reference.Center() - source.Center());
  RelativePose pose;
  pose.rotation.row0 = ToVec3f(rotation.row(0).transpose());
  pose.rotation.row1 = ToVec3f(rotation.row(1).transpose());
  pose.rotation.row2 = ToVec3f(rotation.row(2).transpose());
  pose.translation = ToVec3f(translation);
  return pose;
}

}  // namespace tsar
