// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"
#include "colmap_tsar/tools/plane_export/support_mask.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The outlines and holes of a support (FindSupport), as simple polygons that
// are nowhere further than about 1.5 cells from the borders of its cells.
// Corners within 2 cells of a crease are put onto it, and where two creases
// meet near by, onto their point. The largest polygon is the first.
std::vector<PlanePolygon> TracePolygons(const SupportGrid& grid,
                                        const Image<uint8_t>& support,
                                        const std::vector<CreaseLine>& creases);

}  // namespace tsar
