// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/plane_export/plane_class.h"
#include "colmap_tsar/plane_export/plane_coordinates.h"
#include "colmap_tsar/plane_export/plane_polygon.h"

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// A plane of the scene as it is given to others. World frame, units of the
// sparse model.
struct ExportedPlane {
  int id = 0;  // In planes.bin; plane maps hold 1 + id.
  PlaneClass plane_class = PlaneClass::kOther;
  // Its normal points to where most of its pixels are seen from.
  PlaneCoordinates coordinates;
  // Of the rotation about axis_s and about axis_t (radians), and of the shift
  // along the normal. Infinite variances: not known.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double support = 0.0;  // See ModelPlane.
  int component = 0;
  int frame = -1;
  int axis = -1;
  double area = 0.0;  // Of the polygons.
  double cell =
      0.0;  // The resolution of the polygons; 0 where nothing is seen.
  int64_t num_pixels = 0;
  double share_measured = 0.0;
  struct Sighting {
    std::string image;
    int64_t num_pixels = 0;
  };
  std::vector<Sighting> images;
  std::vector<int> meets;  // The planes with which it has a crease.
  // In its coordinates; the largest first.
  std::vector<PlanePolygon> polygons;

  // normal . X + Offset() = 0.
  double Offset() const { return -coordinates.normal.dot(coordinates.origin); }
};

struct ExportedPlanes {
  std::string type;  // Of the maps: "geometric" or "photometric".
  int num_images = 0;
  Vertical vertical;
  std::vector<Eigen::Matrix3d> frames;  // See SceneModel.
  std::vector<ExportedPlane> planes;    // By id.
};

}  // namespace tsar
