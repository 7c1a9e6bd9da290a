// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/exported_planes.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

struct Triangulation {
  Ring points;  // Of the outline, then of the holes.
  // Counterclockwise; numbers of points.
  std::vector<std::array<int, 3>> triangles;
};

// Covers a simple polygon (IsSimple) with triangles whose corners are its own:
// holes are joined to the outline by cuts, then ears are cut off.
Triangulation Triangulate(const PlanePolygon& polygon);

// The polygons of a plane as triangles in the world frame, counterclockwise
// where its normal points to the viewer.
struct PlaneMesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // Numbers of points.
};

PlaneMesh MakePlaneMesh(const ExportedPlane& plane);

// The shortest text that reads as the same number, whatever the locale.
std::string NumberText(double number);

// Three of these with spaces.
std::string PointText(const Eigen::Vector3d& point);

}  // namespace tsar
