// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/plane_export/plane_polygon.h"

#include <array>
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

}  // namespace tsar
