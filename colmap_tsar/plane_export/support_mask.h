// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/plane_export/crease.h"
#include "colmap_tsar/plane_export/support_grid.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Which cells belong to the support of a plane: 255, the others 0. Those that
// views cover at least half as much as their neighbours, and a tenth as much as
// the median; without gaps, holes and islands of a few cells, and without what
// lies beyond creases on whose other side nearly all of it lies. Cells that
// touch in a corner alone do not occur.
Image<uint8_t> FindSupport(const SupportGrid& grid,
                           const std::vector<CreaseLine>& creases);

}  // namespace tsar
