// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <limits>
#include <optional>
#include <variant>

#include <Eigen/Core>

namespace tsar {

// Colors are 0-255, red first.
struct Material {
  Eigen::Vector3d base;
  Eigen::Vector3d accent;  // The color that the texture goes to.
  double cell = 0.0;       // Width of the coarsest detail in meters; 0: bare.

  bool IsBare() const { return cell == 0.0; }
};

struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;  // Any length; distances count in units of it.
};

// Where a ray meets a surface.
struct SurfacePoint {
  double distance = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal;  // Unit, towards the ray's origin.
  // Position on the surface in meters; the seam of round ones is at their back.
  double u = 0.0;
  double v = 0.0;
};

// A rectangle, seen only from the side to which cross(along_u, along_v) points.
struct Rectangle {
  Rectangle(const Eigen::Vector3d& corner,
            const Eigen::Vector3d& side_u,
            const Eigen::Vector3d& side_v);
  std::optional<SurfacePoint> Meet(const Ray& ray) const;

  Eigen::Vector3d corner;
  Eigen::Vector3d along_u;  // Unit vectors.
  Eigen::Vector3d along_v;
  Eigen::Vector3d normal;
  double length_u;
  double length_v;
};

struct Sphere {
  std::optional<SurfacePoint> Meet(const Ray& ray) const;

  Eigen::Vector3d center;
  double radius;
};

// An upright cylinder of unlimited height, seen from outside.
struct Column {
  std::optional<SurfacePoint> Meet(const Ray& ray) const;

  double center_x;
  double center_z;
  double radius;
};

struct Surface {
  std::variant<Rectangle, Sphere, Column> shape;
  Material material;

  std::optional<SurfacePoint> Meet(const Ray& ray) const {
    return std::visit([&](const auto& s) { return s.Meet(ray); }, shape);
  }
};

}  // namespace tsar
