// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/surfaces.h"

#include <cmath>

#include <Eigen/Geometry>

namespace tsar {
namespace {

// Nearer hits are the surface that the ray started from.
constexpr double kMinDistance = 1e-6;

// Rectangles reach this far over their sides, so that no ray slips through
// where two of them meet.
constexpr double kOverlap = 1e-9;

// The nearer solution of a t^2 + 2 b t + c = 0, where there is one in front.
std::optional<double> NearRoot(double a, double b, double c) {
  const double discriminant = b * b - a * c;
  if (!(discriminant > 0.0)) {
    return std::nullopt;
  }
  const double root = (-b - std::sqrt(discriminant)) / a;
  return root > kMinDistance ? std::optional(root) : std::nullopt;
}

}  // namespace

Rectangle::Rectangle(const Eigen::Vector3d& corner,
                     const Eigen::Vector3d& side_u,
                     const Eigen::Vector3d& side_v)
    : corner(corner),
      along_u(side_u.normalized()),
      along_v(side_v.normalized()),
      normal(along_u.cross(along_v)),
      length_u(side_u.norm()),
      length_v(side_v.norm()) {}

std::optional<SurfacePoint> Rectangle::Meet(const Ray& ray) const {
  const double slope = normal.dot(ray.direction);
  if (!(slope < 0.0)) {
    return std::nullopt;
  }
  const double distance = normal.dot(corner - ray.origin) / slope;
  if (!(distance > kMinDistance)) {
    return std::nullopt;
  }
  const Eigen::Vector3d offset = ray.origin + distance * ray.direction - corner;
  const double u = offset.dot(along_u);
  const double v = offset.dot(along_v);
  if (!(u >= -kOverlap && u <= length_u + kOverlap && v >= -kOverlap &&
        v <= length_v + kOverlap)) {
    return std::nullopt;
  }
  return SurfacePoint{distance, normal, u, v};
}

std::optional<SurfacePoint> Sphere::Meet(const Ray& ray) const {
  const Eigen::Vector3d offset = ray.origin - center;
  const std::optional<double> distance =
      NearRoot(ray.direction.squaredNorm(),
               offset.dot(ray.direction),
               offset.squaredNorm() - radius * radius);
  if (!distance) {
    return std::nullopt;
  }
  const Eigen::Vector3d normal = (offset + *distance * ray.direction) / radius;
  return SurfacePoint{*distance,
                      normal,
                      radius * std::atan2(normal.x(), -normal.z()),
                      radius * std::asin(normal.y())};
}

std::optional<SurfacePoint> Column::Meet(const Ray& ray) const {
  const Eigen::Vector2d direction(ray.direction.x(), ray.direction.z());
  const Eigen::Vector2d offset(ray.origin.x() - center_x,
                               ray.origin.z() - center_z);
  const std::optional<double> distance =
      NearRoot(direction.squaredNorm(),
               offset.dot(direction),
               offset.squaredNorm() - radius * radius);
  if (!distance) {
    return std::nullopt;
  }
  const Eigen::Vector2d normal = (offset + *distance * direction) / radius;
  return SurfacePoint{*distance,
                      {normal.x(), 0.0, normal.y()},
                      radius * std::atan2(normal.x(), -normal.y()),
                      ray.origin.y() + *distance * ray.direction.y()};
}

}  // namespace tsar
