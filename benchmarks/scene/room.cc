// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "benchmarks/scene/room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace tsar {
namespace {

using Eigen::Vector3d;

constexpr double kLeft = -2.8;
constexpr double kRight = 2.8;
constexpr double kCeiling = -1.4;
constexpr double kFloor = 1.3;
constexpr double kFront = -3.0;
constexpr double kBack = 3.0;

// How far pictures and carpet protrude from the surface behind them.
constexpr double kThickness = 0.01;

const Vector3d kLamp(-0.6, -1.2, -0.4);

constexpr double kSpacing = 0.15;
constexpr int kCamerasPerRow = 16;
constexpr int kMaxRows = 8;
// What the cameras look at, and how far from it they stand.
const Vector3d kTarget(0.0, 0.1, 2.2);
constexpr double kArcRadius = 3.6;
// In image widths: a field of view of 64 degrees.
constexpr double kFocalShare = 0.8;

// Nearer hits are the surface that the ray started from.
constexpr double kMinDistance = 1e-6;

// Rectangles extend beyond their sides by this much, so that no ray passes
// between two that meet.
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

Material Bare(double r, double g, double b) { return {{r, g, b}, {}, 0.0}; }

}  // namespace

Rectangle::Rectangle(const Vector3d& corner,
                     const Vector3d& side_u,
                     const Vector3d& side_v)
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
  const Vector3d offset = ray.origin + distance * ray.direction - corner;
  const double u = offset.dot(along_u);
  const double v = offset.dot(along_v);
  if (!(u >= -kOverlap && u <= length_u + kOverlap && v >= -kOverlap &&
        v <= length_v + kOverlap)) {
    return std::nullopt;
  }
  return SurfacePoint{distance, normal, u, v};
}

std::optional<SurfacePoint> Sphere::Meet(const Ray& ray) const {
  const Vector3d offset = ray.origin - center;
  const std::optional<double> distance =
      NearRoot(ray.direction.squaredNorm(),
               offset.dot(ray.direction),
               offset.squaredNorm() - radius * radius);
  if (!distance) {
    return std::nullopt;
  }
  const Vector3d normal = (offset + *distance * ray.direction) / radius;
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

Room::Room(uint32_t seed) : noise_(seed) {
  AddShell();
  AddPicturesAndCarpet();
  AddFurniture();
}

void Room::AddShell() {
  const double width = kRight - kLeft;
  const double height = kFloor - kCeiling;
  const double length = kBack - kFront;
  const Material wall = Bare(214, 208, 196);
  surfaces_ = {
      // Back, front, left, right, floor, ceiling; all face inwards.
      {Rectangle({kLeft, kFloor, kBack}, {width, 0, 0}, {0, -height, 0}),
       Bare(205, 203, 200)},
      {Rectangle({kLeft, kCeiling, kFront}, {width, 0, 0}, {0, height, 0}),
       wall},
      {Rectangle({kLeft, kFloor, kFront}, {0, 0, length}, {0, -height, 0}),
       wall},
      {Rectangle({kRight, kCeiling, kFront}, {0, 0, length}, {0, height, 0}),
       wall},
      {Rectangle({kLeft, kFloor, kFront}, {width, 0, 0}, {0, 0, length}),
       Bare(158, 148, 136)},
      {Rectangle({kLeft, kCeiling, kBack}, {width, 0, 0}, {0, 0, -length}),
       Bare(236, 235, 232)},
  };
}

void Room::AddPicturesAndCarpet() {
  const Material landscape{{60, 96, 70}, {214, 200, 150}, 0.25};
  const Material portrait{{120, 52, 44}, {226, 190, 160}, 0.15};
  const Material map{{70, 90, 150}, {230, 226, 200}, 0.2};
  const Material carpet{{92, 40, 44}, {196, 160, 110}, 0.12};
  surfaces_.insert(
      surfaces_.end(),
      {
          {Rectangle(
               {-2.3, 0.2, kBack - kThickness}, {1.0, 0, 0}, {0, -1.1, 0}),
           portrait},
          {Rectangle(
               {-0.6, -0.1, kBack - kThickness}, {1.5, 0, 0}, {0, -0.9, 0}),
           landscape},
          {Rectangle({kLeft + kThickness, 0.1, 0.2}, {0, 0, 1.2}, {0, -0.9, 0}),
           map},
          {Rectangle(
               {kRight - kThickness, -0.9, 0.9}, {0, 0, 1.0}, {0, 1.0, 0}),
           portrait},
          {Rectangle(
               {-1.7, kFloor - kThickness, 0.2}, {2.6, 0, 0}, {0, 0, 2.1}),
           carpet},
      });
}

void Room::AddFurniture() {
  const Material wood{{96, 62, 36}, {190, 140, 90}, 0.18};
  const Material crate{{130, 110, 70}, {230, 214, 170}, 0.1};
  const Material globe{{36, 70, 130}, {190, 200, 140}, 0.16};
  const Material stone{{110, 108, 104}, {226, 222, 214}, 0.3};
  // A cupboard of wood and one that is painted white.
  AddBox({2.1, 0.45, 2.65}, {1.1, 1.7, 0.6}, 0.0, wood);
  AddBox({-2.4, 0.65, 1.9}, {0.7, 1.3, 0.9}, 0.0, Bare(226, 226, 222));
  // A table without texture with a crate on it, and a crate on the carpet.
  AddBox({0.9, 0.62, 2.3}, {1.0, 0.06, 0.6}, 8.0, Bare(190, 170, 140));
  AddBox({0.8, 0.46, 2.3}, {0.3, 0.26, 0.3}, 30.0, crate);
  AddBox({-1.1, 1.04, 1.5}, {0.5, 0.5, 0.5}, 25.0, crate);
  surfaces_.push_back({Sphere{{-0.1, 0.94, 1.4}, 0.35}, globe});
  surfaces_.push_back({Column{1.7, 1.7, 0.14}, stone});
}

void Room::AddBox(const Vector3d& center,
                  const Vector3d& size,
                  double turn_degrees,
                  const Material& material) {
  const double angle = turn_degrees * std::numbers::pi / 180.0;
  const Vector3d x = size.x() * Vector3d(std::cos(angle), 0, std::sin(angle));
  const Vector3d y(0, size.y(), 0);
  const Vector3d z = size.z() * Vector3d(-std::sin(angle), 0, std::cos(angle));
  const Vector3d low = center - 0.5 * (x + y + z);
  const Vector3d high = center + 0.5 * (x + y + z);
  // All face outwards.
  for (const auto& [u, v] :
       {std::pair(x, y), std::pair(y, z), std::pair(z, x)}) {
    surfaces_.push_back({Rectangle(high, -u, -v), material});
    surfaces_.push_back({Rectangle(low, v, u), material});
  }
}

RoomHit Room::Cast(const Ray& ray) const {
  RoomHit hit;
  for (size_t i = 0; i < surfaces_.size(); ++i) {
    const std::optional<SurfacePoint> point = surfaces_[i].Meet(ray);
    if (point && point->distance < hit.point.distance) {
      hit = {static_cast<int>(i), *point};
    }
  }
  return hit;
}

Vector3d Room::Shade(const Ray& ray,
                     const RoomHit& hit,
                     double footprint) const {
  const Material& material = surfaces_[hit.surface].material;
  Vector3d color = material.base;
  if (!material.IsBare()) {
    // Shifted, so that no two surfaces look the same.
    const double value = noise_.Texture(hit.point.u + 3.7 * hit.surface,
                                        hit.point.v + 5.3 * hit.surface,
                                        material.cell,
                                        footprint);
    color += (0.5 + 0.5 * value) * (material.accent - material.base);
  }
  const Vector3d to_lamp =
      kLamp - (ray.origin + hit.point.distance * ray.direction);
  const double slope =
      std::max(0.0, hit.point.normal.dot(to_lamp.normalized()));
  const double light =
      0.72 + 0.4 * slope / (1.0 + 0.05 * to_lamp.squaredNorm());
  return (light * color).cwiseMin(255.0);
}

Ray PixelRay(const Camera& camera, double x, double y) {
  const Vector3d direction(
      (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0);
  return {camera.Center(), camera.rotation.transpose() * direction};
}

std::vector<Camera> RoomCameras(int num_cameras, int width, int height) {
  const int num_rows =
      std::min(kMaxRows, (num_cameras + kCamerasPerRow - 1) / kCamerasPerRow);
  const int per_row = (num_cameras + num_rows - 1) / num_rows;
  const double spacing =
      kSpacing * std::min(1.0, static_cast<double>(kCamerasPerRow) / per_row);
  std::vector<Camera> cameras;
  for (int i = 0; i < num_cameras; ++i) {
    const double along = i % per_row - 0.5 * (per_row - 1);
    const double up = i / per_row - 0.5 * (num_rows - 1);
    const double angle = along * spacing / kArcRadius;
    // A little up and down along the way, as hands do.
    const Vector3d center(kTarget.x() + kArcRadius * std::sin(angle),
                          0.08 * std::sin(1.9 * i) - spacing * up,
                          kTarget.z() - kArcRadius * std::cos(angle));
    const Vector3d forward = (kTarget - center).normalized();
    const Vector3d right = Vector3d::UnitY().cross(forward).normalized();
    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.fx = kFocalShare * width;
    camera.fy = camera.fx;
    camera.cx = 0.5 * width;
    camera.cy = 0.5 * height;
    camera.rotation.row(0) = right;
    camera.rotation.row(1) = forward.cross(right);
    camera.rotation.row(2) = forward;
    camera.translation = -camera.rotation * center;
    cameras.push_back(camera);
  }
  return cameras;
}

}  // namespace tsar
