// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <array>
#include <filesystem>
#include <ostream>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The walls seen from above. Coordinates are x and y of the planes after they
// were turned until the vertical is z, in their units.
struct FloorPlan {
  struct Wall {
    int id = 0;  // Of the plane.
    // Where its polygons are, along the plane: those that overlap are one.
    std::vector<std::array<Eigen::Vector2d, 2>> segments;
  };
  std::vector<Wall> walls;
  int num_leaning = 0;     // Planes of the class kWall that were left out.
  bool in_meters = false;  // False: in units of the sparse model.
};

// The largest deviation of a wall of a plan from the vertical, in degrees.
inline constexpr double kMaxLean = 5.0;

// Throws Error kUnsupported without a vertical, kNotFound without outlined
// walls.
FloorPlan MakeFloorPlan(const ExportedPlanes& planes);

// Writers of the formats; the same plan becomes the same bytes.
using PlanWriter = void (*)(const FloorPlan& plan, std::ostream* out);
// A picture with a scale bar.
void PutPlanSvg(const FloorPlan& plan, std::ostream* out);
// R12 ASCII: a LINE for each segment, in the layer WALL.
void PutPlanDxf(const FloorPlan& plan, std::ostream* out);

// The writer by the extension of the option plan_path. Throws Error kBadOption.
PlanWriter PlanWriterFor(const std::filesystem::path& path);

}  // namespace tsar
