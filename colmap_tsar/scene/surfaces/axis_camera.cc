// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/axis_camera.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

namespace tsar {
namespace {

// The least cosine between the optical axis and the plane across the axis.
constexpr double kMinCosine = 0.6;
// The least depth in the rectified camera of the image's corners at a depth of
// one in the view.
constexpr double kMinCornerDepth = 0.2;
// The largest extent of the rectified image, in focal lengths,
constexpr double kMaxSlope = 1.5;
// and of the sum of its sides, relative to that of the raster.
constexpr double kMaxEnlargement = 4.0;

// The least distance of a camera from the center, in radii.
constexpr double kMinCenterDistance = 1.2;
// The least cosine between a tangent and the camera's forward direction.
constexpr double kMinTangentCosine = 0.3;

// The largest difference of the radii that follow from the widths in two
// cameras, relative to the larger one: outlines of narrow objects are known to
// a tenth of the width.
constexpr double kMaxRadiusGap = 0.4;

// The ray midway between two columns.
struct MiddleRay {
  Eigen::Vector2d direction;
  // Approximate radius of a circle at a distance of one along the camera's
  // forward direction.
  double radius;
};

MiddleRay MiddleOf(const ColumnPair& pair) {
  const Eigen::Vector2d direction =
      pair.camera.Direction(0.5 * (pair.left + pair.right));
  return {
      direction,
      0.5 * (pair.right - pair.left) / (pair.camera.focal * direction.norm())};
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// The signed distance of a point from a ray is normal.dot(point) - offset,
// which grows to the right.
struct Line {
  Eigen::Vector2d normal;
  double offset;
};

Line LineOf(const CircleTangent& tangent) {
  const Eigen::Vector2d direction =
      tangent.camera->Direction(tangent.column).normalized();
  Eigen::Vector2d normal(-direction.y(), direction.x());
  if (normal.dot(tangent.camera->right) < 0.0) {
    normal = -normal;
  }
  return {normal, normal.dot(tangent.camera->center)};
}

// The size of a pixel of the camera at the circle.
double PixelAt(const AxisCircle& circle, const AxisCamera& camera) {
  return (circle.center - camera.center).norm() / camera.focal;
}

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
  result.view = camera;
  // Where pixels are not square, rectified pixels have the length of the longer
  // side.
  result.focal = std::min(camera.fx, camera.fy);
  result.center = frame.Across(camera.Center());
  result.center_height = frame.along.dot(camera.Center());
  result.right = frame.Across(right);
  result.forward = frame.Across(forward);
  Eigen::Matrix3d axes;  // Axes of the rectified camera in the world.
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
  // The image is not visible, or a coordinate is NaN.
  if (!(size.minCoeff() >= 0.0) ||
      !(size.maxCoeff() <=
        kMaxEnlargement * (double(camera.width) + camera.height))) {
    return std::nullopt;
  }
  result.cx = -low.x() * result.focal;
  result.cy = -low.y() * result.focal;
  result.width = static_cast<int>(size.x()) + 1;
  result.height = static_cast<int>(size.y()) + 1;
  return result;
}

std::optional<CircleOutline> OutlineOf(const AxisCircle& circle,
                                       const AxisCamera& camera) {
  const Eigen::Vector2d to_center = circle.center - camera.center;
  const double distance = to_center.norm();
  if (!(distance > kMinCenterDistance * circle.radius)) {
    return std::nullopt;
  }
  const double length =
      std::sqrt(distance * distance - circle.radius * circle.radius);
  const Eigen::Vector2d aside(-to_center.y(), to_center.x());
  std::vector<std::pair<double, double>> sides;  // Columns and distances.
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector2d tangent =
        (to_center * length + side * circle.radius * aside) /
        (distance * distance);
    const double forward = tangent.dot(camera.forward);
    if (!(forward > kMinTangentCosine * tangent.norm())) {
      return std::nullopt;
    }
    sides.emplace_back(
        camera.cx + camera.focal * tangent.dot(camera.right) / forward,
        forward * length);
  }
  const auto [left, right] = std::ranges::minmax(sides);
  return CircleOutline{left.first, right.first, left.second, right.second};
}

bool MayShowOneCircle(const ColumnPair& a, const ColumnPair& b) {
  const MiddleRay ray_a = MiddleOf(a);
  const MiddleRay ray_b = MiddleOf(b);
  const Eigen::Vector2d between = b.camera.center - a.camera.center;
  // Radii at the intersection of the rays, along either.
  const double area = Cross(ray_a.direction, ray_b.direction);
  const double radius_a = Cross(between, ray_b.direction) / area * ray_a.radius;
  const double radius_b = Cross(between, ray_a.direction) / area * ray_b.radius;
  return radius_a > 0.0 && radius_b > 0.0 &&
         std::abs(radius_a - radius_b) <=
             kMaxRadiusGap * std::max(radius_a, radius_b);
}

std::optional<AxisCircle> FitCircle(const std::vector<CircleTangent>& tangents,
                                    const AxisCircle* near,
                                    Eigen::Matrix3d* covariance) {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();
  for (const CircleTangent& tangent : tangents) {
    origin += tangent.camera->center / tangents.size();
  }
  // Unit of weights, which makes them about 1 at any scale of the scene.
  const double unit = near != nullptr && !tangents.empty()
                          ? PixelAt(*near, *tangents.front().camera)
                          : 1.0;
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right_side = Eigen::Vector3d::Zero();
  for (const CircleTangent& tangent : tangents) {
    const Line line = LineOf(tangent);
    const Eigen::Vector3d row(
        line.normal.x(), line.normal.y(), tangent.is_left ? -1.0 : 1.0);
    const double pixel =
        near != nullptr ? PixelAt(*near, *tangent.camera) / unit : 1.0;
    const double weight = 1.0 / (pixel * pixel);
    matrix += weight * row * row.transpose();
    right_side += weight * (line.offset - line.normal.dot(origin)) * row;
  }
  Eigen::Matrix3d inverse;
  bool is_invertible = false;
  matrix.computeInverseWithCheck(inverse, is_invertible);
  if (!is_invertible) {
    return std::nullopt;
  }
  const Eigen::Vector3d solution = inverse * right_side;
  if (!solution.allFinite() || !(solution.z() > 0.0)) {
    return std::nullopt;
  }
  if (covariance != nullptr) {
    *covariance = inverse * (unit * unit);
  }
  return AxisCircle{origin + solution.head<2>(), solution.z()};
}

std::optional<Eigen::Vector2d> FitPoint(
    const std::vector<CircleTangent>& tangents) {
  Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  for (const CircleTangent& tangent : tangents) {
    const Line line = LineOf(tangent);
    matrix += line.normal * line.normal.transpose();
    right_side += line.offset * line.normal;
  }
  Eigen::Matrix2d inverse;
  bool is_invertible = false;
  matrix.computeInverseWithCheck(inverse, is_invertible);
  return is_invertible ? std::optional<Eigen::Vector2d>(inverse * right_side)
                       : std::nullopt;
}

}  // namespace tsar
