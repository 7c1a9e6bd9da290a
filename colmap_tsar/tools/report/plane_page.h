// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/exported_planes.h"
#include "colmap_tsar/tools/report/point_sample.h"

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The scene planes on the page; its pictures and tsar_planes use the same color
// for each, LabelColor() of its id.
struct PlanePage {
  struct Plane {
    int id = 0;
    PlaneClass plane_class = PlaneClass::kOther;
    double area = 0.0;  // In square units of the sparse model.
    // The angle to horizontal or vertical, whichever is nearer, in degrees;
    // unknown without a vertical.
    std::optional<double> tilt;
    int64_t num_images = 0;
    double share_measured = 0.0;
    // Standard deviation of the offset, in units of the model, if known.
    std::optional<double> sigma;
    // Its part of the mesh.
    int64_t first_vertex = 0;
    int64_t num_vertices = 0;
  };
  // Planes by descending area, then by id.
  std::vector<Plane> planes;
  // Three vertices for each triangle, counterclockwise if the plane's normal
  // points to the viewer; relative to the origin.
  PointSample mesh;
};

PlanePage MakePlanePage(const ExportedPlanes& planes,
                        const Eigen::Vector3d& origin);

}  // namespace tsar
