// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/plane_export/crease.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"
#include "colmap_tsar/tools/plane_export/support_mask.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Traces the outlines and holes of a support (FindSupport) as simple polygons
// within about 1.5 cells of the borders of its cells. Corners within 2 cells of
// a crease are snapped to it, or to the intersection of two creases nearby. The
// largest is first.
std::vector<PlanePolygon> TracePolygons(const SupportGrid& grid,
                                        const Image<uint8_t>& support,
                                        const std::vector<CreaseLine>& creases);

}  // namespace tsar
