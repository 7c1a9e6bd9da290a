// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/plane_polygon.h"
#include "colmap_tsar/tools/plane_export/plane_view.h"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The sine of the least angle (10 degrees) at which the intersection of two
// planes, or of two creases, is well determined.
inline constexpr double kMinSine = 0.17;

// The part of the intersection line of two scene planes that views observe:
// from point + begin * direction to point + end * direction.
struct Crease {
  int first = 0;  // The smaller index.
  int second = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // Unit vector.
  double begin = 0.0;
  double end = 0.0;
  int64_t num_pixels = 0;  // Pairs of neighboring pixels, one of each plane.
};

// A crease in the coordinates of one of its planes.
struct CreaseLine {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();
  double begin = 0.0;
  double end = 0.0;

  // Signed distance from the line, positive on its left; position along it.
  double Height(const Eigen::Vector2d& at) const {
    return Cross(direction, at - point);
  }
  double Along(const Eigen::Vector2d& at) const {
    return direction.dot(at - point);
  }
  // Whether a point is beside the observed part, extended by margin.
  bool IsBeside(const Eigen::Vector2d& at, double margin) const {
    const double along = Along(at);
    return along >= begin - margin && along <= end + margin;
  }
};

// Finds the creases of planes whose labels touch in the added views.
class CreaseFinder {
 public:
  explicit CreaseFinder(const std::vector<PlaneCoordinates>& planes)
      : planes_(planes) {}

  void Add(const PlaneView& view);

  // The creases that enough pixels support, ordered by their planes.
  std::vector<Crease> Creases() const;

 private:
  void AddPair(const PlaneView& view,
               const std::vector<PlaneProjection>& projections,
               const Eigen::Vector2i& pixel,
               const Eigen::Vector2i& neighbor);

  const std::vector<PlaneCoordinates>& planes_;
  // Creases by their planes; those of parallel planes have no direction.
  std::map<std::pair<int, int>, Crease> creases_;
};

// The creases of plane p, in its coordinates.
std::vector<CreaseLine> CreasesOf(int p,
                                  const PlaneCoordinates& coordinates,
                                  const std::vector<Crease>& creases);

}  // namespace tsar
