// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <variant>
#include <vector>

#include "benchmarks/scene/texture.h"
#include <Eigen/Core>

namespace tsar {

// Colors are 0-255, red first.
struct Material {
  Eigen::Vector3d base;
  Eigen::Vector3d accent;  // The other end of the texture's colors.
  double cell = 0.0;       // Width of the coarsest detail in meters; 0: none.

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

// What a ray meets first; surface is an index, or -1 for nothing.
struct RoomHit {
  int surface = -1;
  SurfacePoint point;
};

// A furnished room, in meters; x right, y down, z to the back wall. Walls,
// ceiling, floor, table and one cupboard have no texture; posters, carpet,
// crates, a globe and a column have some.
class Room {
 public:
  explicit Room(uint32_t seed);

  RoomHit Cast(const Ray& ray) const;

  // The color of a hit, 0-255 per channel. footprint: the width of a pixel at
  // the hit, in meters.
  Eigen::Vector3d Shade(const Ray& ray,
                        const RoomHit& hit,
                        double footprint) const;

  bool IsBare(const RoomHit& hit) const {
    return surfaces_[hit.surface].material.IsBare();
  }

 private:
  void AddShell();
  void AddPicturesAndCarpet();
  void AddFurniture();
  // An upright box turned about its vertical axis.
  void AddBox(const Eigen::Vector3d& center,
              const Eigen::Vector3d& size,
              double turn_degrees,
              const Material& material);

  LatticeNoise noise_;
  std::vector<Surface> surfaces_;
};

// The ray of a pixel position; its direction has depth 1, so that distances
// along it are depths.
Ray PixelRay(const Camera& camera, double x, double y);

// Cameras that look into the room from an arc, 15 cm apart, in rows of 16 one
// above the other; with more than 128 they come closer together.
std::vector<Camera> RoomCameras(int num_cameras, int width, int height);

}  // namespace tsar
