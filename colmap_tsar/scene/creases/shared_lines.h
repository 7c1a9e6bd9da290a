// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/creases/plane_lines.h"

#include <vector>

namespace tsar {

// A line that several views see at the same place of a plane.
struct SharedLine {
  PlaneLine line;  // With the median pixel and the mean step.
  int num_views = 0;
};

struct SharedLineOptions {
  // So many views must see a line at the same place,
  int min_views = 3;
  // to so many pixels of the raster.
  float max_gap = 1.5f;
};

// lines: by view; those of different directions of step are different lines.
// Sorted by plane, axis and place.
std::vector<SharedLine> JoinPlaneLines(
    const std::vector<std::vector<PlaneLine>>& lines,
    const SharedLineOptions& options);

}  // namespace tsar
