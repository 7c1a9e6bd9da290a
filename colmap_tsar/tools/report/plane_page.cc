// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/plane_page.h"

#include "colmap_tsar/base/label_color.h"
#include "colmap_tsar/tools/plane_export/plane_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace tsar {
namespace {

std::optional<double> TiltOf(const Eigen::Vector3d& normal,
                             const Vertical& vertical) {
  if (vertical.source == Vertical::Source::kNone) {
    return std::nullopt;
  }
  const double cosine = normal.dot(vertical.up);
  const double from_level =
      std::atan2(normal.cross(vertical.up).norm(), std::abs(cosine)) * 180.0 /
      std::numbers::pi;
  return std::min(from_level, 90.0 - from_level);
}

// Returns the number of vertices.
int64_t AddMesh(const ExportedPlane& plane,
                const Eigen::Vector3d& origin,
                PointSample* sample) {
  const PlaneMesh mesh = MakePlaneMesh(plane);
  const Rgb color = LabelColor(plane.id);
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      sample->Add(mesh.points[corner] - origin, color);
    }
  }
  return 3 * static_cast<int64_t>(mesh.triangles.size());
}

}  // namespace

PlanePage MakePlanePage(const ExportedPlanes& planes,
                        const Eigen::Vector3d& origin) {
  PlanePage page;
  for (const ExportedPlane& exported : planes.planes) {
    PlanePage::Plane plane;
    plane.id = exported.id;
    plane.plane_class = exported.plane_class;
    plane.area = exported.area;
    plane.tilt = TiltOf(exported.coordinates.normal, planes.vertical);
    plane.num_images = static_cast<int64_t>(exported.images.size());
    plane.share_measured = exported.share_measured;
    const double variance = exported.covariance(2, 2);
    if (std::isfinite(variance)) {
      plane.sigma = std::sqrt(variance);
    }
    plane.first_vertex = static_cast<int64_t>(page.mesh.NumPoints());
    plane.num_vertices = AddMesh(exported, origin, &page.mesh);
    page.planes.push_back(plane);
  }
  std::ranges::stable_sort(page.planes, [](const auto& a, const auto& b) {
    return a.area > b.area;
  });
  return page;
}

}  // namespace tsar
