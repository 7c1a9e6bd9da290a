// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/plane_export/plane_mesh.h"
#include "colmap_tsar/plane_export/write_planes.h"

namespace tsar {

void PutPlanesObj(const ExportedPlanes& planes, std::ostream* out) {
  *out << "# planes of the scene, by tsar_planes\n";
  size_t num_points = 0;
  size_t num_normals = 0;
  for (const ExportedPlane& plane : planes.planes) {
    const PlaneMesh mesh = MakePlaneMesh(plane);
    if (mesh.triangles.empty()) {
      continue;
    }
    *out << "g plane_" << plane.id << "_" << ToString(plane.plane_class)
         << "\n";
    for (const Eigen::Vector3d& point : mesh.points) {
      *out << "v " << PointText(point) << "\n";
    }
    *out << "vn " << PointText(plane.coordinates.normal) << "\n";
    ++num_normals;
    for (const auto& triangle : mesh.triangles) {
      *out << "f";
      for (const int corner : triangle) {
        // Counted from 1 through the whole file.
        *out << " " << num_points + static_cast<size_t>(corner) + 1 << "//"
             << num_normals;
      }
      *out << "\n";
    }
    num_points += mesh.points.size();
  }
}

}  // namespace tsar
