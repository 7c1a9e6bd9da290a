// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"

#include <array>
#include <ostream>
#include <string>
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

// Planes lean less than this, in degrees, to be walls of a plan.
inline constexpr double kMaxLean = 5.0;

// Throws Error kUnsupported without a vertical, kNotFound without outlined
// walls.
FloorPlan MakeFloorPlan(const ExportedPlanes& planes);

enum class PlanFormat {
  kSvg,  // A picture with a scale bar.
  kDxf,  // R12 ASCII: a LINE for each segment, in the layer WALL.
};

// The format by the extension of a path. Throws Error kBadOption.
PlanFormat ParsePlanFormat(const std::string& path);

// Writes atomically, the same plan as the same bytes; errors as AtomicFile.
void WriteFloorPlan(const ContainedPath& path,
                    PlanFormat format,
                    const FloorPlan& plan);

// Writers of the formats.
void PutPlanSvg(const FloorPlan& plan, std::ostream* out);
void PutPlanDxf(const FloorPlan& plan, std::ostream* out);

}  // namespace tsar
