// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <vector>

#include "benchmarks/scene/surfaces.h"
#include "benchmarks/scene/texture.h"

namespace tsar {

// What a ray meets first; surface is an index, or -1 for nothing.
struct RoomHit {
  int surface = -1;
  SurfacePoint point;
};

// A furnished room, in meters; x right, y down, z to the back wall. Walls,
// ceiling, floor, table and one cupboard are bare; posters, carpet, crates, a
// globe and a column have texture.
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
    return surfaces_[static_cast<size_t>(hit.surface)].material.IsBare();
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
