// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_mesh.h"

#include "colmap_tsar/plane_export/triangulate.h"

#include <charconv>

namespace tsar {

PlaneMesh MakePlaneMesh(const ExportedPlane& plane) {
  PlaneMesh mesh;
  for (const PlanePolygon& polygon : plane.polygons) {
    const Triangulation triangulation = Triangulate(polygon);
    const int first = static_cast<int>(mesh.points.size());
    for (const Eigen::Vector2d& point : triangulation.points) {
      mesh.points.push_back(plane.coordinates.ToWorld(point));
    }
    for (const auto& [a, b, c] : triangulation.triangles) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return mesh;
}

std::string NumberText(double number) {
  char text[32];
  const std::to_chars_result result =
      std::to_chars(text, text + sizeof(text), number);
  return std::string(text, result.ptr);
}

std::string PointText(const Eigen::Vector3d& point) {
  return NumberText(point.x()) + " " + NumberText(point.y()) + " " +
         NumberText(point.z());
}

}  // namespace tsar
