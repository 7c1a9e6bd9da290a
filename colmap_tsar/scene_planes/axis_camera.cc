// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/axis_camera.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// The least cosine between the optical axis and the plane across the axis.
constexpr double kMinCosine = 0.6;
// The least depth in the rectified camera of the image's corners at a depth of
// one in the view.
constexpr double kMinCornerDepth = 0.2;
// The rectified image reaches no further, in focal lengths,
constexpr double kMaxSlope = 1.5;
// and its sides are no longer than this multiple of the raster's together.
constexpr double kMaxEnlargement = 4.0;

}  // namespace

std::optional<AxisCamera> MakeAxisCamera(const Camera& camera,
                                         const AxisFrame& frame) {
  const Eigen::Vector3d optical_axis = camera.rotation.row(2);
  Eigen::Vector3d forward =
      optical_axis - frame.along * frame.along.dot(optical_axis);
  if (forward.norm() < kMinCosine) {
    return std::nullopt;
  }
  forward.normalize();
  const Eigen::Vector3d right = frame.along.cross(forward);
  AxisCamera result;
  // Where pixels are not square, the rectified ones are as the longer side is.
  result.focal = std::min(camera.fx, camera.fy);
  result.center = frame.Across(camera.Center());
  result.center_height = frame.along.dot(camera.Center());
  result.right = frame.Across(right);
  result.forward = frame.Across(forward);
  Eigen::Matrix3d axes;  // Of the rectified camera, in the world.
  axes << right, frame.along, forward;
  result.to_view = camera.rotation * axes;
  Eigen::Array2d low = Eigen::Array2d::Constant(HUGE_VAL);
  Eigen::Array2d high = -low;
  for (const double x : {0.0, camera.width - 1.0}) {
    for (const double y : {0.0, camera.height - 1.0}) {
      const Eigen::Vector3d ray =
          result.to_view.transpose() *
          Eigen::Vector3d(
              (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
      if (!(ray.z() > kMinCornerDepth)) {
        return std::nullopt;
      }
      const Eigen::Array2d slopes = ray.head<2>().array() / ray.z();
      low = low.min(slopes);
      high = high.max(slopes);
    }
  }
  low = low.max(-kMaxSlope);
  high = high.min(kMaxSlope);
  const Eigen::Array2d size = (high - low) * result.focal;
  // Nothing of the image, or what is no number.
  if (!(size.minCoeff() >= 0.0) ||
      !(size.maxCoeff() <=
        kMaxEnlargement *
            (static_cast<double>(camera.width) + camera.height))) {
    return std::nullopt;
  }
  result.cx = -low.x() * result.focal;
  result.cy = -low.y() * result.focal;
  result.width = static_cast<int>(size.x()) + 1;
  result.height = static_cast<int>(size.y()) + 1;
  return result;
}

}  // namespace tsar
