// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/plane_export/plane_mesh.h"
#include "colmap_tsar/plane_export/write_planes.h"

namespace tsar {

void PutPlanesPly(const ExportedPlanes& planes, std::ostream* out) {
  std::vector<PlaneMesh> meshes;
  size_t num_points = 0;
  size_t num_triangles = 0;
  for (const ExportedPlane& plane : planes.planes) {
    meshes.push_back(MakePlaneMesh(plane));
    num_points += meshes.back().points.size();
    num_triangles += meshes.back().triangles.size();
  }
  // Doubles, for the coordinates of georeferenced models.
  *out << "ply\nformat ascii 1.0\n"
       << "comment planes of the scene, by tsar_planes\n"
       << "element vertex " << num_points << "\n"
       << "property double x\nproperty double y\nproperty double z\n"
       << "property uchar red\nproperty uchar green\nproperty uchar blue\n"
       << "element face " << num_triangles << "\n"
       << "property list uchar int vertex_indices\nproperty int plane\n"
       << "end_header\n";
  for (size_t i = 0; i < meshes.size(); ++i) {
    const Rgb color = LabelColor(planes.planes[i].id);
    for (const Eigen::Vector3d& point : meshes[i].points) {
      *out << PointText(point) << " " << int{color.r} << " " << int{color.g}
           << " " << int{color.b} << "\n";
    }
  }
  size_t first = 0;
  for (size_t i = 0; i < meshes.size(); ++i) {
    for (const auto& triangle : meshes[i].triangles) {
      *out << "3";
      for (const int corner : triangle) {
        *out << " " << first + static_cast<size_t>(corner);
      }
      *out << " " << planes.planes[i].id << "\n";
    }
    first += meshes[i].points.size();
  }
}

}  // namespace tsar
