// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

struct Triangulation {
  Ring points;  // Points of the outline, then of the holes.
  // Indices of points, counterclockwise.
  std::vector<std::array<int, 3>> triangles;
};

// Triangulates a simple polygon (IsSimple) without new points: holes are joined
// to the outline by bridges, then ears are clipped.
Triangulation Triangulate(const PlanePolygon& polygon);

// Triangles in the world frame, counterclockwise against the normal.
struct PlaneMesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // Indices of points.
};

PlaneMesh MakePlaneMesh(const ExportedPlane& plane);

// The shortest text that reads as the same number, whatever the locale.
std::string NumberText(double number);

// The three coordinates, separated by spaces.
std::string PointText(const Eigen::Vector3d& point);

}  // namespace tsar
